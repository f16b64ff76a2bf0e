#pragma once
// A replay as `zenith view` plays it: OUT/timeline.jsonl. Its first line names the robots, each
// further one is a line of telemetry with its robot and moment:
//
//   {"timeline":1,"robots":["r1","r2"]}
//   {"t_s":0.1,"robot":0,"line":{"type":"pose",...}}
//
// In the order of time. Pictures are JPEG, as base64.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "platform/base/result.h"
#include "tools/view/telemetry_line.h"

namespace zenith::tools {

inline constexpr const char* kTimelineFile = "timeline.jsonl";

// Its lines are kept as text, for decoded they take more than ten times the memory: who plays it
// decodes them again.
struct Timeline {
  struct Entry {
    double t_s = 0.0;
    std::uint32_t robot = 0;
    std::uint32_t bytes = 0;  // of `text`
    std::uint64_t at = 0;
    bool is_picture = false;  // a whole one: most of a timeline's bytes
  };
  // A merge, or its withdrawal.
  struct Mark {
    double t_s = 0.0;
    std::string text;
  };

  std::vector<std::string> robots;
  std::vector<std::pair<std::size_t, TelemetryLine>> before;  // of robots, ahead of all entries
  std::vector<Entry> entries;
  std::string text;
  std::vector<Mark> marks;
  double duration_s = 0.0;
  std::size_t refused = 0;  // entries whose line is none of telemetry's: left out

  // At its end: a line of telemetry, and its text.
  void add(double t_s, std::size_t robot, const TelemetryLine& line, std::string_view line_text);
  DecodedLine line_of(const Entry& entry) const;
};

// Puts merges and withdrawals into a timeline: tell it all lines in their order.
class MarkFinder {
 public:
  void note(Timeline& timeline, double t_s, std::size_t robot, const TelemetryLine& line);

 private:
  std::map<std::string, std::string> states_;  // of alignments: "ROBOT/PEER"
};

// A regular file of at most kMostTimelineBytes.
inline constexpr std::uintmax_t kMostTimelineBytes = std::uintmax_t{512} << 20U;
Result<Timeline> read_timeline(const std::filesystem::path& file);

}  // namespace zenith::tools
