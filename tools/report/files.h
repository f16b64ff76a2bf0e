#pragma once
// The text files of a replay's output: trajectories, landmarks, alignments, confidence, summary.
//
//   <robot>/trajectory.tum   estimated base_link in the robot's own start frame
//   <robot>/landmarks.csv    the robot's own landmarks
//   <robot>/alignments.csv   a row at every change of state, every second, and at the end
//   <robot>/confidence.csv   a row for every frame and peer; 0 while there is no candidate
//   summary.json             figures, counters, memory, parameters

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "slam/image/view.h"
#include "slam/parameters.h"
#include "tools/clocks/alignment.h"
#include "tools/report/figures.h"
#include "tools/runner/run_log.h"

namespace zenith::tools {

struct RunDescription {
  std::uint64_t seed = 1;
  Parameters parameters;
  std::vector<std::vector<std::string>> warnings;  // by robot
  Alignment alignment;                             // of their clocks; empty: stamps as recorded
  std::vector<View> views;                         // by robot
};

// Into `folder`, which exists.
Status write_files(const std::filesystem::path& folder, const TeamLog& log,
                   const TeamFigures& figures, const RunDescription& run);

}  // namespace zenith::tools
