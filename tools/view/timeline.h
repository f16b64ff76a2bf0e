#pragma once
// A replay as `zenith view` plays it: OUT/timeline.jsonl. Its first line names the robots, each
// further one is a line of telemetry with its robot and moment:
//
//   {"timeline":1,"robots":["r1","r2"]}
//   {"t_s":0.1,"robot":0,"line":{"type":"pose",...}}
//
// In the order of time. Pictures are JPEG, as base64.

#include <filesystem>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "tools/view/telemetry_line.h"

namespace zenith::tools {

inline constexpr const char* kTimelineFile = "timeline.jsonl";

struct Timeline {
  struct Entry {
    double t_s = 0.0;
    std::size_t robot = 0;
    TelemetryLine line;
  };
  // A merge, or its withdrawal.
  struct Mark {
    double t_s = 0.0;
    std::string text;
  };

  std::vector<std::string> robots;
  std::vector<Entry> entries;
  std::vector<Mark> marks;
  double duration_s = 0.0;
  std::size_t refused = 0;  // entries whose line is none of telemetry's: left out
};

// Its merges and withdrawals, from the entries.
void find_marks(Timeline& timeline);

// A regular file of at most kMostTimelineBytes.
inline constexpr std::uintmax_t kMostTimelineBytes = std::uintmax_t{512} << 20U;
Result<Timeline> read_timeline(const std::filesystem::path& file);

}  // namespace zenith::tools
