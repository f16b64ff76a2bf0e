#include "slam/filter/frame_clock.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace zenith {
namespace {

constexpr int kLeastFrames = 8;
constexpr double kLeastJitter_s = 0.002;  // below, there is nothing to gain
constexpr double kCorrelation = -0.2;     // of neighbouring intervals: below, stamps jitter
constexpr double kMostIntervals = 3.0;    // a longer gap begins anew: the camera may have stopped
constexpr double kBeside = 2.0;           // of the stamps' variance: above, frames leave the line
constexpr double kOutlier = 0.7;          // intervals: another number of them, rather than jitter
constexpr double kFarthest = 1.5;         // intervals that a stamp may be off
constexpr double kLost = 2.5;             // intervals beside the line: another frame rate

template <std::size_t N>
double median_of(FixedVector<double, N> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace

void FrameClock::begin(Time stamp) {
  *this = {};
  begun_ = true;
  origin_ = last_ = last_taken_ = stamp;
  first_.push_back(0.0);
}

// By how much an interval differs from what it should be: sigma^2 of the stamps is half its mean
// square.
void FrameClock::judge(double deviation_s, double off_s) {
  const double most = kFarthest * period_s_;
  const double deviation = std::clamp(deviation_s, -most, most);
  const double share = 1.0 / std::min(frames_, kMemory / 2);
  square_ += share * (deviation * deviation - square_);
  product_ += share * (deviation * last_deviation_s_ - product_);
  beside_ += share * (off_s * off_s - beside_);
  last_deviation_s_ = deviation;
  sigma_s_ = std::sqrt(0.5 * square_);
  corrects_ = frames_ >= kLeastFrames && sigma_s_ > kLeastJitter_s &&
              product_ < kCorrelation * square_ && beside_ < kBeside * sigma_s_ * sigma_s_;
}

// From the first frames: their mean interval, a longer one counting as two where its excess is no
// scatter, and their line.
void FrameClock::begin_line() {
  FixedVector<double, kFirst> intervals;
  for (std::size_t i = 1; i < first_.size(); ++i) intervals.push_back(first_[i] - first_[i - 1]);
  const double median_s = median_of(intervals);
  FixedVector<double, kFirst> deviations;
  for (const double interval : intervals) deviations.push_back(std::abs(interval - median_s));
  // Of a Gaussian, and of the difference of two stamps.
  sigma_s_ = 1.48 * median_of(deviations) / std::numbers::sqrt2;
  square_ = 2.0 * sigma_s_ * sigma_s_;
  const double all_s = first_[first_.size() - 1] - first_[0];
  const double mean_s = all_s / static_cast<double>(intervals.size());
  const double single_s = mean_s * (1.0 + std::clamp(8.0 * sigma_s_ / mean_s, 0.6, kFarthest));
  double count = 0.0;
  for (const double i : intervals) count += i < single_s ? 1.0 : std::round(i / mean_s);
  period_s_ = all_s / count;
  phase_s_ = last_s_ = first_[0];
  p00_ = 1.0;
  p01_ = 0.0;
  p11_ = 0.05;
  for (std::size_t i = 1; i < first_.size(); ++i) follow(first_[i]);
}

double FrameClock::scatter(double period_s) const {
  return std::clamp(4.5 * sigma_s_ / period_s, 0.7, kFarthest);
}

// A frame at `t`. False: it is of no such line.
bool FrameClock::follow(double t) {
  ++frames_;
  // The next interval, unless the stamp is too far from it for its jitter. 0: the last one was
  // taken for two.
  const double intervals = (t - phase_s_) / period_s_;
  const double n =
      std::abs(intervals - 1.0) < scatter(period_s_) ? 1.0 : std::max(0.0, std::round(intervals));
  const double deviation = t - last_s_ - n * period_s_;
  last_s_ = t;
  // Old frames fade, so that the line follows a slow change.
  constexpr double kFade = 1.0 / (1.0 - 1.0 / kMemory);
  phase_s_ += n * period_s_;
  p00_ = (p00_ + 2.0 * n * p01_ + n * n * p11_) * kFade;
  p01_ = (p01_ + n * p11_) * kFade;
  p11_ *= kFade;
  const double off = t - phase_s_;
  if (std::abs(off) > kLost * period_s_) return false;
  judge(deviation, off);
  if (std::abs(off) > std::max(kOutlier * period_s_, 2.5 * sigma_s_)) return true;
  const double k0 = p00_ / (p00_ + 1.0);
  const double k1 = p01_ / (p00_ + 1.0);
  phase_s_ += k0 * off;
  period_s_ += k1 * off;
  p11_ -= k1 * p01_;
  p01_ -= k0 * p01_;
  p00_ -= k0 * p00_;
  return period_s_ > 0.0;
}

Time FrameClock::taken(Time stamp) {
  const double interval_s = (stamp - last_).seconds();
  if (!begun_ || interval_s <= 0.0) {
    begin(stamp);
    return stamp;
  }
  const Time earliest = last_taken_ + Duration{1};
  const bool gap = period_s_ > 0.0 && interval_s > kMostIntervals * period_s_;
  if (gap) {
    begin(stamp);
    return last_taken_ = std::max(stamp, earliest);
  }
  last_ = stamp;
  const double t = (stamp - origin_).seconds();
  if (period_s_ == 0.0) {
    if (first_.push_back(t); first_.full()) begin_line();
  } else if (!follow(t)) {
    begin(stamp);
  }
  Time moment = stamp;
  if (corrects_) {
    const double beside = std::clamp(phase_s_ - t, -kFarthest * period_s_, kFarthest * period_s_);
    moment = stamp + Duration{std::llround(beside * 1e9)};
  }
  return last_taken_ = std::max(moment, earliest);
}

}  // namespace zenith
