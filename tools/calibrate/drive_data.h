#pragma once
// A recorded drive as its calibration sees it: where points of the ceiling were seen from, and what
// the wheels said meanwhile. Seconds count from the first frame.

#include <algorithm>
#include <vector>

#include <Eigen/Core>

#include "slam/filter/motion.h"
#include "slam/robot.h"

namespace zenith::tools {

// The total travel of the wheels as the base reports it, by its frames' stamps.
class WheelCurve {
 public:
  // In the order of time.
  void add(double time_s, const WheelTravel& total) { points_.push_back({time_s, total}); }
  bool empty() const { return points_.empty(); }

  // Interpolated; beyond the ends it stands still.
  WheelTravel at(double time_s) const {
    const auto after = std::lower_bound(points_.begin(), points_.end(), time_s,
                                        [](const Point& p, double t) { return p.time_s < t; });
    if (after == points_.begin()) return points_.front().total;
    if (after == points_.end()) return points_.back().total;
    const Point& a = *(after - 1);
    const Point& b = *after;
    const double f = (time_s - a.time_s) / (b.time_s - a.time_s);
    return {a.total.left_m + f * (b.total.left_m - a.total.left_m),
            a.total.right_m + f * (b.total.right_m - a.total.right_m)};
  }

 private:
  struct Point {
    double time_s;
    WheelTravel total;
  };
  std::vector<Point> points_;
};

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
  int tracks = 0;
  int images = 0;

  // What the wheels say between two times when their frames are late by `latency_s`.
  WheelTravel travel(double from_s, double to_s, double latency_s) const {
    const WheelTravel a = wheels.at(from_s + latency_s);
    const WheelTravel b = wheels.at(to_s + latency_s);
    return {b.left_m - a.left_m, b.right_m - a.right_m};
  }
};

}  // namespace zenith::tools
