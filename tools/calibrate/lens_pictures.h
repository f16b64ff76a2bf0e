#pragma once
// Pictures of a lens's calibration: where corners were seen and where they are missing; by how much
// they were missed, and where.

#include <filesystem>

#include "platform/base/result.h"
#include "tools/calibrate/lens_calibration.h"

namespace zenith::tools {

Status draw_coverage(const LensCalibration& calibration, const std::filesystem::path& path);
Status draw_residuals(const LensCalibration& calibration, const std::filesystem::path& path);

}  // namespace zenith::tools
