#pragma once
// Worlds for tests: written to a temporary file, removed with the object.

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

namespace zenith::sim {

class TestWorld {
 public:
  explicit TestWorld(const std::string& toml) {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            (std::string("zenith-") + info->test_suite_name() + "-" + info->name() + ".toml");
    std::ofstream(path_) << toml;
  }
  ~TestWorld() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TestWorld(const TestWorld&) = delete;
  TestWorld& operator=(const TestWorld&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// One room of 6 x 5 m with lamps, a robot that knows its camera exactly and a camera without
// noise, dark enough that lamps do not saturate.
inline std::string exact_room(const std::string& camera_extra = "") {
  return R"(
seed = 5
[[room]]
name = "room"
rect = [0.0, 0.0, 6.0, 5.0]
ceiling_m = 2.6
ceiling = "blank"
walls = "blank"
clutter = 0.0
[camera]
mount_m = [0.07, -0.03, 0.31]
roll_pitch_yaw_deg = [1.5, -2.0, 5.0]
full_well_e = 1e6
read_noise_e = 0
blur_px = 0
)" + camera_extra +
         R"(
[calibration_error]
principal_px = 0
focal_relative = 0
tilt_deg = 0
yaw_deg = 0
lever_m = 0
[[robot]]
name = "r"
path = [[2.0, 2.0], [4.0, 2.6]]
exposure_ev = -3.0
start_heading_deg = 40
)";
}

}  // namespace zenith::sim
