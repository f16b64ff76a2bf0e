#include "slam/filter/motion.h"

#include <algorithm>
#include <utility>

namespace zenith {
namespace {

double square(double x) {
  return x * x;
}

}  // namespace

MotionIncrement motion_increment(const Wheels& wheels, const WheelTravel& travel,
                                 const MotionNoise& noise) {
  MotionIncrement out;
  out.mean = wheel_motion(wheels, travel);
  const double way = 0.5 * (std::abs(travel.left_m) + std::abs(travel.right_m));
  if (way == 0.0) return out;
  const double b = wheels.track_width_m;
  out.covariance(0, 0) = square(noise.distance_per_sqrt_m) * way + 0.5 * square(noise.floor_m);
  out.covariance(1, 1) = square(noise.lateral_per_sqrt_m) * way;
  out.covariance(2, 2) = square(noise.turn_per_sqrt_m) * way + 2.0 * square(noise.floor_m / b);
  return out;
}

MotionIncrement operator*(const MotionIncrement& first, const MotionIncrement& second) {
  const Eigen::Matrix2d back = rotation(-second.mean.theta_rad);
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
  A.topLeftCorner<2, 2>() = back;
  A.topRightCorner<2, 1>() = back * Eigen::Vector2d(-second.mean.y_m, second.mean.x_m);
  return {first.mean * second.mean, A * first.covariance * A.transpose() + second.covariance};
}

PoseEstimate operator*(const PoseEstimate& pose, const MotionIncrement& motion) {
  const Pose2 end = pose.mean * motion.mean;
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F(0, 2) = -(end.y_m - pose.mean.y_m);
  F(1, 2) = end.x_m - pose.mean.x_m;
  Eigen::Matrix3d G = Eigen::Matrix3d::Identity();
  G.topLeftCorner<2, 2>() = rotation(end.theta_rad);
  return {end, F * pose.covariance * F.transpose() + G * motion.covariance * G.transpose()};
}

bool WheelHistory::add(const WheelSample& sample) {
  if (!is_within(sample.left_m, kMostTravel_m) || !is_within(sample.right_m, kMostTravel_m)) {
    return false;
  }
  const StampGuard::Verdict verdict = stamps_.take(sample.stamp);
  if (verdict == StampGuard::Verdict::kRefused) return false;
  if (size_ > 0) {
    const WheelSample& last = nth(size_ - 1);
    const bool new_time = verdict == StampGuard::Verdict::kNewTime;
    const Duration longest = {10'000'000'000};
    const double interval_s =
        new_time ? 0.0 : std::min(sample.stamp - last.stamp, longest).seconds();
    const double most_m = kWheelSlack_m + kFastest_m_per_s * interval_s;
    if (!is_within(sample.left_m - told_.left_m, most_m) ||
        !is_within(sample.right_m - told_.right_m, most_m)) {
      shift_ = {last.left_m - sample.left_m, last.right_m - sample.right_m};
      ++jumps_;
    }
    if (new_time) size_ = 0;
  }
  told_ = {sample.left_m, sample.right_m};
  if (size_ == kMaxWheelSamples) {
    head_ = (head_ + 1) % kMaxWheelSamples;
    --size_;
  }
  samples_[(head_ + size_) % kMaxWheelSamples] = {sample.stamp, sample.left_m + shift_.left_m,
                                                  sample.right_m + shift_.right_m};
  ++size_;
  return true;
}

WheelHistory::At WheelHistory::at(Time stamp) const {
  if (size_ == 0) return {};
  const WheelSample& newest = nth(size_ - 1);
  if (size_ == 1 || stamp <= nth(0).stamp) {
    const WheelSample& only = nth(0);
    return {{only.left_m, only.right_m}, stamp != only.stamp, true};
  }
  // The pair around the stamp, or the last pair when the stamp lies beyond it.
  int i = size_ - 1;
  while (i > 1 && nth(i - 1).stamp >= stamp) --i;
  const WheelSample& a = nth(i - 1);
  const WheelSample& b = nth(i);
  const bool beyond = stamp > newest.stamp;
  constexpr Duration kHold = {100'000'000};
  const Time t = beyond ? std::min(stamp, newest.stamp + kHold) : stamp;
  const double s =
      static_cast<double>((t - a.stamp).ns) / static_cast<double>((b.stamp - a.stamp).ns);
  const WheelTravel there = {a.left_m + s * (b.left_m - a.left_m),
                             a.right_m + s * (b.right_m - a.right_m)};
  // Two samples right after each other tell no speed.
  const double most_m = kWheelSlack_m + kFastest_m_per_s * kHold.seconds();
  if (beyond && (!is_within(there.left_m - b.left_m, most_m) ||
                 !is_within(there.right_m - b.right_m, most_m))) {
    return {{b.left_m, b.right_m}, true, true};
  }
  return {there, beyond, true};
}

void WheelMotion::build(const Wheels& wheels, const MotionNoise& noise) {
  wheels_ = wheels;
  noise_ = noise;
}

bool WheelMotion::add(const WheelSample& sample) {
  const int before = history_.size();
  if (begun_ && before == kMaxWheelSamples) integrate_until(history_.nth(1).stamp);
  if (!history_.add(sample)) return false;
  // Of a new time: the history begins with this sample.
  if (begun_ && history_.size() < before) here_ = sample.stamp;
  return true;
}

WheelMotion::Since WheelMotion::advance(Time stamp) {
  const WheelHistory::At at = history_.at(stamp);
  Since since;
  since.known = at.known;
  since.extrapolated = !at.known || at.extrapolated;
  if (!at.known) return since;
  if (begun_) {
    integrate_until(stamp);
    step_to(stamp, at.total);
  } else {
    begun_ = true;
    here_ = stamp;
    total_ = at.total;
  }
  since.motion = std::exchange(motion_, {});
  return since;
}

void WheelMotion::integrate_until(Time stamp) {
  int i = history_.size();
  while (i > 0 && history_.nth(i - 1).stamp > here_) --i;
  for (; i < history_.size() && history_.nth(i).stamp <= stamp; ++i) {
    const WheelSample& sample = history_.nth(i);
    step_to(sample.stamp, {sample.left_m, sample.right_m});
  }
}

void WheelMotion::step_to(Time stamp, const WheelTravel& total) {
  const WheelTravel travel = {total.left_m - total_.left_m, total.right_m - total_.right_m};
  here_ = stamp;
  total_ = total;
  if (travel.left_m == 0.0 && travel.right_m == 0.0) return;
  MotionNoise noise = noise_;
  noise.floor_m = 0.0;
  motion_ = motion_ * motion_increment(wheels_, travel, noise);
}

MotionIncrement WheelMotion::with_floor(const MotionIncrement& motion) const {
  MotionIncrement out = motion;
  if (motion.covariance.isZero(0.0)) return out;
  out.covariance(0, 0) += 0.5 * square(noise_.floor_m);
  out.covariance(2, 2) += 2.0 * square(noise_.floor_m / wheels_.track_width_m);
  return out;
}

}  // namespace zenith
