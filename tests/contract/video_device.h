#pragma once
// A video device of the kernel that a test may pull out.

#include <string>

namespace zenith {

// The one that $ZENITH_TEST_VIDEO names, "/dev/video50". Plugged in at the end. Failures are test
// failures.
class VideoDevice {
 public:
  VideoDevice();
  ~VideoDevice();
  VideoDevice(const VideoDevice&) = delete;
  VideoDevice& operator=(const VideoDevice&) = delete;

  // Why there is none; empty when there is.
  const std::string& missing() const { return missing_; }
  const std::string& path() const { return path_; }
  // Takes the device from its driver, and gives it back. Root.
  void set_plugged(bool plugged);

 private:
  std::string path_;
  std::string missing_;
  std::string driver_;  // folder of the driver in /sys, and the device's name there
  std::string name_;
  bool plugged_ = true;
};

}  // namespace zenith
