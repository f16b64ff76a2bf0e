#pragma once
// Judges the output of a replay against the ground truth of its recordings, from the files alone.

#include <filesystem>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "tools/report/figures.h"

namespace zenith::tools {

// A robot is found by the name of its recording's folder. Step times, landmarks and duplicates are
// taken from summary.json; alignments are known once a second, so that figures between are those
// of the row before.
Result<TeamFigures> judge_output(const std::filesystem::path& output,
                                 const std::vector<std::filesystem::path>& recordings);

}  // namespace zenith::tools
