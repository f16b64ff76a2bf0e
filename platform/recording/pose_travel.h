#pragma once
// odometry.tum: the poses of base_link in its own odometry frame, turned back into wheel travel.
//
// Between two poses the robot drove an arc: it turned by dtheta, and its way there is the chord
// from one to the other, along the mean heading. With h = dtheta / 2 and the track width b
//
//   s     = h / sin(h) * ((x2 - x1) cos(theta1 + h) + (y2 - y1) sin(theta1 + h))
//   left  = s - b h        right = s + b h
//
// s is negative when it drove backward, and 0 when it turned on the spot. Signed projections do not
// add up the noise of rounded poses, as lengths of chords would.
//
// The travel so far is told in whole tenths of a millimetre: what rounded poses leave while the
// robot stands is no motion.
//
// Between poses 0.06 s to 0.25 s apart samples are added, every 25 ms or less, along a cubic that
// has the same speed on both sides of a pose.
//
// The travel is that of the base's own wheels, before left_scale and right_scale: b is the track
// width with which the base made the poses, so that what calibration corrects is not undone.

#include <filesystem>

#include "platform/base/result.h"
#include "platform/linux/input_file.h"
#include "platform/recording/ground_truth.h"
#include "platform/recording/robot_file.h"
#include "platform/recording/wheel_log.h"
#include "slam/wheels.h"

namespace zenith {

struct ArcTravel {
  double left_m = 0.0;
  double right_m = 0.0;
  double sideways_m = 0.0;  // of the chord, across the mean heading: no wheel makes it
};

// From one pose to another; the turn between them is less than half a one.
ArcTravel arc_travel(const Pose2& from, const Pose2& to, double track_width_m);

// As parse_travel_file(): malformed lines, stamps that do not rise and impossible steps are
// counted. An error, too: poses that cannot be those of a base with two wheels, because they lean,
// move sideways, or turn by more than 2 rad from one to the next.
Result<WheelLog> parse_pose_travel(InputLines& lines, const RobotFile& robot);
Result<WheelLog> read_pose_travel(const std::filesystem::path& path, const RobotFile& robot);

}  // namespace zenith
