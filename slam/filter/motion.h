#pragma once
// The motion of a differential drive from its wheels' travel.
//
//   d = (right + left) / 2,   dtheta = (right - left) / track_width
//   the robot moves on an arc: chord d sinc(dtheta / 2), direction dtheta / 2
//
// Source: Thrun, Burgard, Fox, "Probabilistic Robotics", 5.4, in the exact-arc form.
//
// Only between two samples of the wheels is the way an arc. Over more of them, however far apart
// the frames are, motions are composed, with errors xi = (forward, left, turn) in the body at the
// motion's end:
//
//   u = u1 + u2,   xi = A xi1 + xi2,   A = Ad(u2^-1),   Q = A Q1 A^T + Q2
//
// A turns xi1 into the axes of the end, and its turn carries the end sideways by u2.

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "platform/base/time.h"
#include "slam/bounds.h"
#include "slam/capacity.h"
#include "slam/geometry.h"
#include "slam/robot.h"
#include "slam/wheels.h"

namespace zenith {

struct WheelTravel {
  double left_m = 0.0;
  double right_m = 0.0;
};

// The pose reached from the origin of base_link by this travel.
inline Pose2 wheel_motion(const Wheels& wheels, const WheelTravel& travel) {
  const double left = travel.left_m * wheels.left_scale;
  const double right = travel.right_m * wheels.right_scale;
  const double d = 0.5 * (left + right);
  const double dtheta = (right - left) / wheels.track_width_m;
  const double half = 0.5 * dtheta;
  const double chord = std::abs(half) < 1e-9 ? d : d * std::sin(half) / half;
  return {chord * std::cos(half), chord * std::sin(half), dtheta};
}

// What the wheels say of a motion: its mean in the body, and Q over (forward, left, turn).
struct MotionIncrement {
  Pose2 mean;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

// Standard deviations of odometry. Distance and turn are apart: unequal wheels and slip spoil the
// turn long before the distance (Borenstein, Feng, "UMBmark", 1995).
struct MotionNoise {
  double distance_per_sqrt_m = 0.002;  // m, after one metre
  double turn_per_sqrt_m = 0.02;       // rad, after one metre
  double lateral_per_sqrt_m = 0.002;   // m, sideways slip after one metre
  double floor_m = 0.0003;             // of one wheel's increment: quantisation, backlash
};

// One arc. No travel, no noise: a standing robot stays.
MotionIncrement motion_increment(const Wheels& wheels, const WheelTravel& travel,
                                 const MotionNoise& noise);

// The one motion and then the other.
MotionIncrement operator*(const MotionIncrement& first, const MotionIncrement& second);

// A pose after a motion: P' = F P F^T + G Q G^T, F = dx'/dx, G turns the body's axes into the
// pose's.
PoseEstimate operator*(const PoseEstimate& pose, const MotionIncrement& motion);

// Keeps the newest wheel samples and tells the total travel at any stamp among them. Full: the
// oldest is overwritten. Beyond the newest sample the last speed is held for at most 100 ms.
class WheelHistory {
 public:
  // False when the sample is refused: beyond the bounds (slam/bounds.h), or not newer than the
  // last. Samples of a clock that was set back are taken again after kOtherClockSamples. A total
  // that jumps further than a wheel turns counts as no travel, and the next ones go on from it.
  bool add(const WheelSample& sample);
  std::uint64_t jumps() const { return jumps_; }

  struct At {
    WheelTravel total;
    bool extrapolated = false;
    bool known = false;  // false before the first sample
  };
  At at(Time stamp) const;

  int size() const { return size_; }
  // The i-th oldest that is kept; its travel is the total without jumps.
  const WheelSample& nth(int i) const { return samples_[(head_ + i) % kMaxWheelSamples]; }

 private:
  std::array<WheelSample, kMaxWheelSamples> samples_ = {};
  int head_ = 0;
  int size_ = 0;
  WheelTravel told_;   // by the last sample
  WheelTravel shift_;  // from what samples tell to the total without jumps
  StampGuard stamps_{kOtherClockSamples};
  std::uint64_t jumps_ = 0;
};

// The robot's motion between stamps, integrated sample by sample. Nothing is left out, however many
// samples there are: what the history must overwrite is integrated before.
class WheelMotion {
 public:
  void build(const Wheels& wheels, const MotionNoise& noise);

  // As WheelHistory::add().
  bool add(const WheelSample& sample);
  std::uint64_t jumps() const { return history_.jumps(); }
  const WheelHistory& history() const { return history_; }

  struct Since {
    MotionIncrement motion;     // without the floor of the noise
    bool extrapolated = false;  // or unknown
    bool known = false;         // false before the first sample
  };
  // The motion from the last call to `stamp`; none in the first call that knows the wheels. Stamps
  // that do not rise are of another clock: what the wheels travelled is then one arc.
  Since advance(Time stamp);

  // The motion as one increment of the filter: with the floor of the noise, unless it stood.
  MotionIncrement with_floor(const MotionIncrement& motion) const;

 private:
  void integrate_until(Time stamp);
  void step_to(Time stamp, const WheelTravel& total);

  Wheels wheels_;
  MotionNoise noise_;
  WheelHistory history_;
  MotionIncrement motion_;  // up to here since the last call of advance()
  Time here_;
  WheelTravel total_;  // here
  bool begun_ = false;
};

}  // namespace zenith
