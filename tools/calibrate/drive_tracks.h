#pragma once
// Follows corners of the ceiling from frame to frame, by their looks.

#include <functional>

#include "platform/base/result.h"
#include "platform/recording/source.h"
#include "tools/calibrate/drive_data.h"

namespace zenith::tools {

// Reads all of `source`. Frames in between that are too near to the last kept one serve to follow
// corners, and are not kept. An error when it cannot be read or too little is left.
Result<DriveData> track_drive(Source& source, const std::function<void(double)>& progress);

}  // namespace zenith::tools
