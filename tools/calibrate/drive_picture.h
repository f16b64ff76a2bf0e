#pragma once
// The way of a drive: as the ceiling shows it, and as the wheels alone tell it before and after.

#include <filesystem>

#include "platform/base/result.h"
#include "tools/calibrate/drive_calibration.h"

namespace zenith::tools {

Status draw_drive(const DriveData& data, const DriveCalibration& calibration,
                  const std::filesystem::path& path);

}  // namespace zenith::tools
