#pragma once
// Maps recordings together and writes everything that comes out.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/recording/recording.h"
#include "slam/parameters.h"
#include "tools/clocks/alignment.h"
#include "tools/report/figures.h"

namespace zenith::tools {

struct ReplayPlan {
  std::vector<std::filesystem::path> recordings;
  std::uint64_t seed = 1;
  bool joint = false;  // aligned robots go on in one filter
  Parameters parameters;
  ReadOptions reading;
  std::map<std::string, double> wheels_late_s;  // by robot
  AlignOptions align;
};

struct ReplayResult {
  TeamFigures figures;
  std::vector<std::string> notes;  // how the clocks of the recordings were aligned
  std::vector<std::string> warnings;
  std::vector<std::string> views;  // a line for each robot: what its rectified image shows
  std::size_t memory_bytes = 0;    // of each robot
};

// Into `folder`, which the caller keeps atomic.
Result<ReplayResult> replay(const ReplayPlan& plan, const std::filesystem::path& folder,
                            const std::function<void(double)>& progress);

}  // namespace zenith::tools
