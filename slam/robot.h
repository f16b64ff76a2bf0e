#pragma once
// What is known about a robot before it moves: its lens, where the camera sits, its wheels.
// Written into robot.toml and sensor.yaml of a recording, and into the daemon's configuration.

#include "slam/geometry.h"
#include "slam/image/lens.h"

namespace zenith {

// Pose of the camera in base_link. The camera's z axis points up when roll and pitch are zero;
// then its x axis (image columns) is the robot's forward at yaw zero.
// R_base_camera = Rz(yaw) Ry(pitch) Rx(roll).
struct CameraMount {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.3;
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
  double yaw_rad = 0.0;
};

// Differential drive. The codec turns CAN frames into travel of each wheel in metres; the scales
// correct it. `sigma` values describe the noise that the motion model assumes.
struct Wheels {
  double track_width_m = 0.40;
  double left_scale = 1.0;
  double right_scale = 1.0;
};

struct RobotConfig {
  Lens lens;
  CameraMount mount;
  Wheels wheels;
  double frame_rate_hz = 15.0;
};

}  // namespace zenith
