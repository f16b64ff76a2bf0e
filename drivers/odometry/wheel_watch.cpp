#include "drivers/odometry/wheel_watch.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace zenith {
namespace {

constexpr double kWindow = 400.0;  // steps; then the older ones count half
constexpr double kLeastBad = 6.0;
constexpr double kMostShare = 0.03;
// With more, the size of the steps says nothing: a swapped byte order makes powers of two as well.
constexpr double kWrapShare = 0.3;
constexpr int kSameJumps = 4;
constexpr double kSameSize = 0.15;
constexpr double kStandsAfter_m = 6.0;
constexpr double kStands_m = 0.005;

}  // namespace

void WheelWatch::moved() {
  good_ += 1.0;
  if (good_ + bad_ < kWindow) return;
  good_ *= 0.5;
  bad_ *= 0.5;
}

void WheelWatch::jumped(double units) {
  bad_ += 1.0;
  const double size = std::isfinite(units) ? std::abs(units) : 0.0;
  const bool same = std::abs(size - jump_units_) <= kSameSize * jump_units_ && size > 0.0;
  same_jumps_ = same ? std::min(same_jumps_ + 1, kSameJumps) : 1;
  // Wraps come short of the full width by the step itself: the largest is the nearest to it.
  jump_units_ = same ? std::max(jump_units_, size) : size;
  if (good_ + bad_ < kWindow) return;
  good_ *= 0.5;
  bad_ *= 0.5;
}

void WheelWatch::travelled(double left_m, double right_m) {
  left_path_m_ += std::abs(left_m - left_m_);
  right_path_m_ += std::abs(right_m - right_m_);
  left_m_ = left_m;
  right_m_ = right_m;
}

WheelFault WheelWatch::fault() const {
  WheelFault fault;
  const double share = bad_ / std::max(good_ + bad_, 1.0);
  fault.share = share;
  fault.jump_units = jump_units_;
  if (same_jumps_ >= kSameJumps && share < kWrapShare) {
    fault.kind = WheelFaultKind::kWraps;
  } else if (bad_ >= kLeastBad && share >= kMostShare) {
    fault.kind = WheelFaultKind::kNonsense;
  } else if (left_path_m_ < kStands_m && right_path_m_ > kStandsAfter_m) {
    fault.kind = WheelFaultKind::kLeftStands;
    fault.travel_m = right_path_m_;
  } else if (right_path_m_ < kStands_m && left_path_m_ > kStandsAfter_m) {
    fault.kind = WheelFaultKind::kRightStands;
    fault.travel_m = left_path_m_;
  }
  return fault;
}

std::string wheel_fault_text(const WheelFault& fault) {
  char text[400] = "";
  const bool left = fault.kind == WheelFaultKind::kLeftStands;
  switch (fault.kind) {
    case WheelFaultKind::kNone:
      break;
    case WheelFaultKind::kNonsense:
      std::snprintf(text, sizeof text,
                    "the wheels are read wrong: %.0f %% of their last steps are faster than "
                    "max_wheel_speed_mps, expected none; compare [odometry] with what the base "
                    "sends: the signals, their byte order, width and sign, and the unit",
                    100.0 * fault.share);
      break;
    case WheelFaultKind::kWraps: {
      const double bits = std::log2(std::max(fault.jump_units, 1.0));
      const bool power = std::abs(bits - std::round(bits)) < 0.1 && bits > 5.0;
      char wrap[80];
      if (power) std::snprintf(wrap, sizeof wrap, "at %.0f bits", std::round(bits));
      if (!power) std::snprintf(wrap, sizeof wrap, "after about %.4g units", fault.jump_units);
      std::snprintf(text, sizeof text,
                    "the wheels are read wrong: their position jumps by the same %.4g units again "
                    "and again, so the base wraps it %s; expected the width that [odometry] says: "
                    "read it as wide as it is, or use velocities",
                    fault.jump_units, wrap);
      break;
    }
    case WheelFaultKind::kLeftStands:
    case WheelFaultKind::kRightStands:
      std::snprintf(text, sizeof text,
                    "the %s wheel never moved while the %s one rolled %.1f m, expected both to "
                    "turn; check in [odometry] which signal, identifier or node is the %s wheel's, "
                    "its width and byte order, and its sensor",
                    left ? "left" : "right", left ? "right" : "left", fault.travel_m,
                    left ? "left" : "right");
      break;
  }
  return text;
}

}  // namespace zenith
