#pragma once
// The picture of the merged map (the paper's Fig. 5).

#include <filesystem>

#include "platform/base/result.h"
#include "tools/report/figures.h"
#include "tools/runner/run_log.h"

namespace zenith::tools {

Status draw_map(const std::filesystem::path& path, const TeamLog& log, const TeamFigures& figures);

}  // namespace zenith::tools
