#pragma once
// Trajectories in TUM's format: timestamp x y z qx qy qz qw, seconds and metres.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "platform/base/result.h"
#include "platform/base/time.h"
#include "platform/linux/input_file.h"
#include "slam/geometry.h"

namespace zenith {

struct StampedPose {
  Time stamp;
  Pose2 pose;  // the yaw of the quaternion; height, roll and pitch are dropped
};

struct TumLine {
  StampedPose pose;
  double lean_rad = 0.0;  // of its z axis against the vertical
};

// 'seconds x y z qx qy qz qw' with a unit quaternion; anything else is nothing.
std::optional<TumLine> parse_tum_line(std::string_view line);

// Stamps rise strictly.
Result<std::vector<StampedPose>> parse_tum(InputLines& lines);
Result<std::vector<StampedPose>> read_tum(const std::filesystem::path& path);

// One line, with its end.
std::string format_tum(const StampedPose& pose);

// Interpolated between two poses that are at most half a second apart; else empty.
std::optional<Pose2> pose_at(const std::vector<StampedPose>& poses, Time stamp);

}  // namespace zenith
