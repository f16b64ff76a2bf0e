#pragma once
// robot.toml of a recording: what is known about the robot but for its camera, which sensor.yaml
// describes, mount included. Unknown keys are errors. What the codec of the base needs has defaults
// and stands under [odometry] and [odometry.<codec>]; wheel_codec_fields() lists the keys.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/odometry/wheel_codec_config.h"
#include "platform/base/result.h"
#include "platform/base/time.h"
#include "slam/robot.h"

namespace zenith {

struct RobotFile {
  Wheels wheels;
  WheelCodecConfig odometry;
  // odometry.tum: the track width with which the base made its poses; 0: that of `wheels`.
  double poses_track_width_m = 0.0;
  // A CAN log of another clock than the frames': when its first line came, on theirs; negative: the
  // log is stamped by their clock.
  double log_start_s = -1.0;

  std::optional<Time> log_start() const;
  std::string can_interface = "can0";  // the log is named after it: can0.log
};

// What tells of the wheels. Without a CAN log, no codec and no interface need be named.
enum class OdometryKeys { kCan, kNone };

// A relative dbc.file is taken from the folder of robot.toml. Where odometry.csv or odometry.tum
// stands beside it, the codec may be left out.
Result<RobotFile> read_robot_file(const std::filesystem::path& path);
// `path` is where the text comes from.
Result<RobotFile> parse_robot_file(std::string_view text, const std::filesystem::path& path,
                                   OdometryKeys keys = OdometryKeys::kCan);

// The annotated text of the file.
std::string format_robot_file(const RobotFile& robot);

}  // namespace zenith
