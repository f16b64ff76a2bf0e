#pragma once
// Exposure, gain and mains frequency, set by the kernel's control numbers (names differ).

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/camera/v4l2_device.h"
#include "drivers/camera/v4l2_settings.h"

namespace zenith {

struct V4l2Control {
  std::uint32_t id = 0;
  std::string name;
  int min = 0;
  int max = 0;
  int step = 1;
  int standard = 0;  // the driver's default
  int value = 0;
  bool read_only = false;
  std::vector<std::string> choices;  // of a menu: "1: Manual Mode"
};

// Whole numbers, switches and menus; other kinds are left out.
std::vector<V4l2Control> list_v4l2_controls(const V4l2Device& device);

// Sets what the settings ask for. What cannot be set, or not as asked, comes back as a sentence:
// a camera without exposure control is still a camera.
std::vector<std::string> apply_v4l2_controls(const V4l2Device& device,
                                             const V4l2Settings& settings);

}  // namespace zenith
