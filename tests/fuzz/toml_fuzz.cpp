// Any text as a recording's robot.toml. What is read is written as a file that says the same.

#include <cstdint>
#include <string_view>

#include "platform/recording/robot_file.h"
#include "tests/fuzz/require.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto robot = zenith::parse_robot_file(text, "robot.toml");
  if (!robot) {
    require(robot.error().message.starts_with("robot.toml"));
    return 0;
  }
  require(robot->wheels.track_width_m > 0.0);
  const auto written = zenith::format_robot_file(*robot);
  const auto again = zenith::parse_robot_file(written, "robot.toml");
  require(again.ok());
  require(again->can_interface == robot->can_interface);
  require(again->odometry.kind == robot->odometry.kind);
  return 0;
}
