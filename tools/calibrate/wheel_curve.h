#pragma once
// The total travel of the wheels as the base reports it, by its frames' stamps, and what may be
// wrong with it: exchanged or reversed wheels, stamps that are late.

#include <algorithm>
#include <utility>
#include <vector>

#include "slam/filter/motion.h"

namespace zenith::tools {

// Which reading is which wheel's: exchanged first, then reversed, as [odometry] has it.
struct WheelOrder {
  bool swap = false;
  bool invert_left = false;
  bool invert_right = false;

  bool operator==(const WheelOrder&) const = default;
  WheelTravel of(const WheelTravel& told) const {
    WheelTravel t = told;
    if (swap) std::swap(t.left_m, t.right_m);
    if (invert_left) t.left_m = -t.left_m;
    if (invert_right) t.right_m = -t.right_m;
    return t;
  }
  // This one done to what `first` has made.
  WheelOrder after(const WheelOrder& first) const {
    return {swap != first.swap, invert_left != (swap ? first.invert_right : first.invert_left),
            invert_right != (swap ? first.invert_left : first.invert_right)};
  }
};

class WheelCurve {
 public:
  // In the order of time.
  void add(double time_s, const WheelTravel& total) { points_.push_back({time_s, total}); }
  bool empty() const { return points_.empty(); }
  // Of one that is not empty.
  double begin_s() const { return points_.front().time_s; }
  double end_s() const { return points_.back().time_s; }

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

  // What the wheels say between two times.
  WheelTravel between(double from_s, double to_s) const {
    const WheelTravel a = at(from_s);
    const WheelTravel b = at(to_s);
    return {b.left_m - a.left_m, b.right_m - a.right_m};
  }

  // With these wheels, whose stamps were late by `delay_s`.
  WheelCurve corrected(const WheelOrder& order, double delay_s) const {
    WheelCurve out;
    for (const Point& p : points_) out.add(p.time_s - delay_s, order.of(p.total));
    return out;
  }

 private:
  struct Point {
    double time_s;
    WheelTravel total;
  };
  std::vector<Point> points_;
};

}  // namespace zenith::tools
