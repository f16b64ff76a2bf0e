#pragma once
// The picture of the confidence over the frames (the paper's Fig. 6).

#include <filesystem>

#include "platform/base/result.h"
#include "tools/runner/run_log.h"

namespace zenith::tools {

Status draw_confidence(const std::filesystem::path& path, const TeamLog& log, double threshold);

}  // namespace zenith::tools
