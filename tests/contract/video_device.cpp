#include "tests/contract/video_device.h"

#include <linux/videodev2.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "drivers/camera/v4l2_controls.h"
#include "drivers/camera/v4l2_device.h"
#include "platform/linux/clock.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;

// vivid stamps the end of an exposure for which it does not wait: a moment to come. Its beginning
// has passed.
void stamp_what_has_passed(const std::string& path) {
  const auto device = open_v4l2_device(kernel_v4l2_io(), path);
  ASSERT_TRUE(device.ok()) << device.error().message;
  for (const V4l2Control& control : list_v4l2_controls(*device)) {
    if (control.name != "Timestamp Source") continue;
    v4l2_control start_of_exposure = {control.id, 1};
    ASSERT_EQ(device->control(VIDIOC_S_CTRL, &start_of_exposure), 0);
  }
}

}  // namespace

VideoDevice::VideoDevice() {
  const char* path = std::getenv("ZENITH_TEST_VIDEO");
  if (path == nullptr || *path == '\0') {
    missing_ = "no camera of the kernel: ZENITH_TEST_VIDEO is not set";
    return;
  }
  path_ = path;
  std::error_code code;
  const fs::path device =
      fs::path("/sys/class/video4linux") / fs::path(path_).filename() / "device";
  name_ = fs::canonical(device, code).filename().string();
  driver_ = fs::canonical(device / "driver", code).string();
  if (code) {
    missing_ = path_ + " is no video device of a driver in /sys";
    return;
  }
  stamp_what_has_passed(path_);
}

VideoDevice::~VideoDevice() {
  if (!plugged_) set_plugged(true);
}

void VideoDevice::set_plugged(bool plugged) {
  std::ofstream(driver_ + (plugged ? "/bind" : "/unbind")) << name_ << std::flush;
  plugged_ = plugged;
  for (int i = 0; i < 500 && fs::exists(path_) != plugged; ++i) {
    sleep_until(monotonic_now() + Duration{20'000'000});
  }
  ASSERT_EQ(fs::exists(path_), plugged) << path_ << " by " << driver_ << " " << name_;
}

}  // namespace zenith
