#pragma once
// Cameras behind libcamera: sensors that need an image signal processor, such as those of the
// Raspberry Pi.
//
// libcamera brings two dozen libraries and threads of its own, so the driver is a module,
// zenith-libcamera.so, which is built where the library is found and loaded where it is asked for.

#include <memory>

#include "drivers/camera/camera.h"
#include "drivers/camera/v4l2_settings.h"
#include "platform/base/result.h"

namespace zenith {

// Loads the module, once and for good, before threads with deadlines start. The error says what to
// install. At most one of these cameras at a time is open.
Result<std::unique_ptr<Camera>> make_libcamera_camera(const V4l2Settings& settings);

}  // namespace zenith
