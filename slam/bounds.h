#pragma once
// What the core's numbers may be at most, in every build. No input and no rounding may carry one
// beyond: what lies beyond is refused, or replaced by the smallest repair that is right, and
// counted (counters.h). A robot that maps a building stays far within.
//
// Every test here is false for what is no number.

#include <cmath>
#include <cstdint>

#include <Eigen/Core>

#include "platform/base/time.h"
#include "slam/geometry.h"

namespace zenith {

// From a map's origin to a pose or a landmark: floats still resolve 8 mm there.
inline constexpr double kFarthest_m = 1e5;
// Of a pose or a place: of two that lie so far apart.
inline constexpr double kMostVariance = kFarthest_m * kFarthest_m;
// Of a wheel, and what its counter may jump besides: backlash, stamps of two clocks.
inline constexpr double kFastest_m_per_s = 30.0;
inline constexpr double kWheelSlack_m = 0.5;
// Total travel of a wheel: a double still resolves 0.1 um.
inline constexpr double kMostTravel_m = 1e9;
// Stamps: 73 years to each side of the clock's zero. Their differences fit as well.
inline constexpr std::int64_t kLatest_ns = std::int64_t{1} << 61;
// What lies so far back was stamped by another clock, or what came before it was.
inline constexpr Duration kOtherClock = {1'000'000'000};
inline constexpr int kOtherClockFrames = 5;
inline constexpr int kOtherClockSamples = 20;

inline bool is_within(double value, double limit) {
  return std::abs(value) <= limit;
}

inline bool is_usable(Time stamp) {
  return stamp.ns >= -kLatest_ns && stamp.ns <= kLatest_ns;
}

// Whether stamps rise. One that does not is refused; but when so many in a row lie far back and
// rise among themselves, the clock was set, and the last of them begins a new time.
class StampGuard {
 public:
  explicit StampGuard(int patience) : patience_(patience) {}

  enum class Verdict { kTaken, kRefused, kNewTime };
  Verdict take(Time stamp) {
    if (!is_usable(stamp)) return Verdict::kRefused;
    if (!begun_ || stamp > last_) return accept(stamp, Verdict::kTaken);
    back_ = last_ - stamp > kOtherClock ? (back_ > 0 && stamp > refused_ ? back_ + 1 : 1) : 0;
    refused_ = stamp;
    return back_ < patience_ ? Verdict::kRefused : accept(stamp, Verdict::kNewTime);
  }

 private:
  Verdict accept(Time stamp, Verdict verdict) {
    begun_ = true;
    last_ = stamp;
    back_ = 0;
    return verdict;
  }

  int patience_;
  bool begun_ = false;
  Time last_;     // taken
  Time refused_;  // the last one, when back_ > 0
  int back_ = 0;
};

inline bool is_usable(const Pose2& pose) {
  return is_within(pose.x_m, kFarthest_m) && is_within(pose.y_m, kFarthest_m) &&
         is_within(pose.theta_rad, 8.0);
}

// The upper triangle xx xy xz yy yz zz: not negative in any direction but for rounding, by all
// principal minors, and within kMostVariance.
template <typename Number>
bool is_covariance(const Number& m) {
  const double xx = m[0], xy = m[1], xz = m[2], yy = m[3], yz = m[4], zz = m[5];
  for (const double variance : {xx, yy, zz}) {
    if (!(variance >= 0.0 && variance <= kMostVariance)) return false;
  }
  constexpr double kRounding = 1e-5;
  const auto at_least = [](double minor, double scale) { return minor >= -kRounding * scale; };
  const double determinant =
      xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
  return at_least(xx * yy - xy * xy, xx * yy) && at_least(xx * zz - xz * xz, xx * zz) &&
         at_least(yy * zz - yz * yz, yy * zz) && at_least(determinant, xx * yy * zz);
}

inline bool is_covariance(const Eigen::Matrix3d& c) {
  const double upper[6] = {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
  return is_covariance(upper);
}

}  // namespace zenith
