#include "slam/watch/slip_watch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slam/geometry.h"

namespace zenith {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMemory_s = 1.2;
// A wheel that jerks by 4 cm on a joint of the floor turns a narrow robot by 6 degrees: the filter
// takes that.
constexpr double kTurn_rad = 7.5 * kDegree;
constexpr double kForward_m = 0.07;
constexpr double kForwardShare = 0.02;  // of the ceiling's height, under high ones
constexpr double kShare = 0.25;         // of these, in one interval
constexpr double kStraight_m = 0.02;
constexpr double kPlaces = 0.15;  // how fast a new height of the ceiling is learned
constexpr int kSettled = 4;       // intervals matched in a row
constexpr double kShortWay_m = 0.25;
constexpr double kShortTurn_rad = 10.0 * kDegree;
constexpr double kShort_s = 0.6;
// Corners that agree: what is seen is not an accident.
constexpr int kClear = 14;
constexpr double kClearShare = 0.25;

}  // namespace

void SlipWatch::add(const VisualMotion& seen, const ToldMotion& told, double interval_s,
                    double per_m, Time now, Reasons& reasons) {
  const bool clear = seen.inliers >= kClear && seen.share >= kClearShare;
  matched_in_row_ = clear ? std::min(matched_in_row_ + 1, kSettled) : 0;
  if (matched_in_row_ == kSettled) {
    if (unmatched_ > 0) reasons.happened(SetupCode::kViewJumped, unmatched_, now);
    unmatched_ = 0;
  }
  if (matched_in_row_ == 0) unmatched_ = 0;
  if (!clear) return;
  if (per_m_ <= 0.0) per_m_ = per_m;
  const double fade = std::exp(-interval_s / kMemory_s);
  turn_rad_ *= fade;
  forward_m_ *= fade;
  const double seen_m = seen.shift.x() / per_m_;
  const double turn_off_rad = wrap_angle(seen.turn_rad - told.turn_rad);
  turn_rad_ += turn_off_rad;
  // Another height of the ceiling changes the distances by a factor, a slip by an amount.
  const double ratio = told.forward_m != 0.0 ? seen_m / told.forward_m : 0.0;
  const bool ordinary = std::abs(told.forward_m) > kStraight_m && ratio > 0.4 && ratio < 2.5;
  const double forward_off_m = ordinary ? 0.0 : seen_m - told.forward_m;
  forward_m_ += forward_off_m;
  if (ordinary) per_m_ *= std::exp(kPlaces * std::log(ratio));
  const double least_m = std::max(kForward_m, kForwardShare / per_m_);
  // Told of when it happens: what is left of it in the sums afterwards is no event.
  if (std::abs(turn_rad_) > kTurn_rad && turn_off_rad * turn_rad_ > 0.0 &&
      std::abs(turn_off_rad) > kShare * kTurn_rad) {
    const bool pushed = std::abs(seen.turn_rad) > std::abs(told.turn_rad);
    reasons.happened(pushed ? SetupCode::kRobotPushed : SetupCode::kWheelsSlipped,
                     std::abs(turn_rad_) / kDegree, now);
  } else if (std::abs(forward_m_) > least_m && forward_off_m * forward_m_ > 0.0 &&
             std::abs(forward_off_m) > kShare * least_m) {
    const bool pushed = std::abs(seen_m) > std::abs(told.forward_m);
    reasons.happened(pushed ? SetupCode::kRobotPushed : SetupCode::kWheelsSlipped,
                     100.0 * std::abs(forward_m_), now);
  }
}

void SlipWatch::add_unmatched(const ToldMotion& told, double interval_s) {
  const bool small = std::abs(told.forward_m) < kShortWay_m && interval_s < kShort_s &&
                     std::abs(told.turn_rad) < kShortTurn_rad;
  if (small && (matched_in_row_ >= kSettled || unmatched_ > 0)) ++unmatched_;
  matched_in_row_ = 0;
}

}  // namespace zenith
