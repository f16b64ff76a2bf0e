#pragma once
// A recorded drive as its calibration sees it: where points of the ceiling were seen from, and what
// the wheels said meanwhile. Seconds count from the first frame.

#include <vector>

#include <Eigen/Core>

#include "slam/robot.h"
#include "tools/calibrate/seen_motion.h"
#include "tools/calibrate/wheel_curve.h"

namespace zenith::tools {

struct Sighting {
  int track = 0;        // the same point of the ceiling
  Eigen::Vector3d ray;  // unit, camera frame
};

struct DriveFrame {
  double time_s = 0.0;
  std::vector<Sighting> sightings;
};

struct DriveData {
  RobotConfig believed;
  WheelCurve wheels;
  std::vector<DriveFrame> frames;  // a few centimetres or degrees apart
  std::vector<SeenInterval> seen;  // the motion between frames, without the wheels
  int tracks = 0;
  int images = 0;

  // What the wheels say between two times when their frames are late by `latency_s`.
  WheelTravel travel(double from_s, double to_s, double latency_s) const {
    return wheels.between(from_s + latency_s, to_s + latency_s);
  }
};

}  // namespace zenith::tools
