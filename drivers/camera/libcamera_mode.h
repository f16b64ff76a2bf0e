#pragma once
// Finds a camera of libcamera, and agrees with it on format and size.

#include <memory>
#include <string>

#include <libcamera/camera.h>
#include <libcamera/camera_manager.h>

#include "drivers/camera/luma_format.h"
#include "drivers/camera/v4l2_settings.h"
#include "platform/base/result.h"

namespace zenith {

struct LibcameraMode {
  std::unique_ptr<libcamera::CameraConfiguration> configuration;  // of one stream, validated
  LumaFormat luma;
};

// "imx219 /base/soc/i2c0mux/i2c@1/imx219@10"
std::string libcamera_name(const libcamera::Camera& camera);

// The one whose id or model holds `part`; the only one when that is empty. The error lists all.
Result<std::shared_ptr<libcamera::Camera>> find_libcamera_camera(
    const libcamera::CameraManager& manager, const std::string& part);

// The size must be had exactly; of the formats that can be read, the cheapest. The error lists what
// the camera offers.
Result<LibcameraMode> negotiate_libcamera(libcamera::Camera& camera, const V4l2Settings& settings);

}  // namespace zenith
