#include "tools/calibrate/setup_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace zenith::tools {
namespace {

constexpr int kLeastIntervals = 20;
constexpr double kLeastTurn_rad = 1.0;  // in all, to both sides
constexpr double kLeastCovered = 0.6;   // of the seen turns' power, by a delay
constexpr double kPlain_m = 0.02;       // a turn that is off by more counts less: Huber's loss
constexpr double kFloor_m2 = 1e-7;      // of an interval: 0.1 degrees at 0.4 m
constexpr int kRounds = 3;
// As slam/watch: standard deviations, gain, share of the turns' power that may be left.
constexpr double kClear = 3.5;
constexpr double kLeastGain = 1.15;
constexpr double kExplained = 0.15;

class Fitter {
 public:
  Fitter(std::span<const SeenInterval> seen, const WheelCurve& wheels, const Wheels& believed)
      : seen_(seen), wheels_(wheels), believed_(believed), weights_(seen.size(), 1.0) {
    for (const SeenInterval& i : seen) power_ += turn_m(i) * turn_m(i);
  }

  bool covers(const SeenInterval& i, double delay_s) const {
    return i.from_s + delay_s >= wheels_.begin_s() && i.to_s + delay_s <= wheels_.end_s();
  }

  double turn_m(const SeenInterval& i) const {
    return 0.5 * believed_.track_width_m * i.seen.turn_rad;
  }

  // (l + r) / 2 and (r - l) / 2
  Eigen::Vector2d told(const SeenInterval& i, double delay_s) const {
    const WheelTravel t = wheels_.between(i.from_s + delay_s, i.to_s + delay_s);
    const double left = t.left_m * believed_.left_scale;
    const double right = t.right_m * believed_.right_scale;
    return {0.5 * (left + right), 0.5 * (right - left)};
  }

  FitSums sums(double delay_s) const {
    FitSums out;
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      const SeenInterval& i = seen_[k];
      if (!covers(i, delay_s)) continue;
      const Eigen::Vector2d u = told(i, delay_s);
      out.add(u.x(), u.y(), turn_m(i), {i.seen.shift.x(), i.seen.shift.y()}, weights_[k]);
    }
    return out;
  }

  // Share of the turns' power that the wheels do not explain; 2 where they do not tell enough.
  double rest(double delay_s) const {
    const FitSums s = sums(delay_s);
    if (s.n < kLeastIntervals || s.tt < kLeastCovered * power_) return 2.0;
    const WheelFit f = fit(s);
    return f.known ? f.turn_rest : 2.0;
  }

  void weigh(double delay_s) {
    const WheelFit f = fit(sums(delay_s));
    power_ = 0.0;
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      const double turn = turn_m(seen_[k]);
      if (covers(seen_[k], delay_s)) {
        const Eigen::Vector2d u = told(seen_[k], delay_s);
        const double off = std::abs(turn - f.alpha1 * u.x() - f.alpha2 * u.y());
        weights_[k] = off > kPlain_m ? kPlain_m / off : 1.0;
      }
      power_ += weights_[k] * turn * turn;
    }
  }

  // The coarse best of a range, in steps of those of DelayedFits.
  double best_in(DelayRange range) const {
    const double step_s = DelayedFits::kStep.seconds();
    // From the middle outwards: of delays that are alike, as where nothing turns, the nearest.
    const double middle = std::clamp(0.0, range.from_s, range.to_s);
    double best = middle;
    double least = rest(middle);
    const auto steps =
        static_cast<int>(std::ceil(std::max(range.to_s - middle, middle - range.from_s) / step_s));
    for (int k = 1; k <= steps; ++k) {
      for (const double d : {middle + k * step_s, middle - k * step_s}) {
        if (d < range.from_s || d > range.to_s) continue;
        const double r = rest(d);
        if (r >= least) continue;
        least = r;
        best = d;
      }
    }
    return best;
  }

  DelayedFits around(double delay_s) const {
    DelayedFits fits;
    for (int i = 0; i < DelayedFits::kDelays; ++i) {
      fits.sums(i) = sums(delay_s + DelayedFits::delay(i).seconds());
    }
    return fits;
  }

  double forward_m(double delay_s) const {
    double sum = 0.0;
    for (const SeenInterval& i : seen_) sum += told(i, delay_s).x();
    return sum;
  }

 private:
  std::span<const SeenInterval> seen_;
  const WheelCurve& wheels_;
  Wheels believed_;
  std::vector<double> weights_;
  double power_ = 0.0;  // of all turns, weighted
};

}  // namespace

bool SetupFit::delay_is_sure() const {
  return known && std::abs(delay_s) > kClear * delay_sigma_s && gain > kLeastGain &&
         fit.turn_rest < kExplained;
}

SetupFit fit_setup(std::span<const SeenInterval> seen, const WheelCurve& wheels,
                   const Wheels& believed, DelayRange range) {
  SetupFit out;
  out.intervals = static_cast<int>(seen.size());
  double turned_rad = 0.0;
  for (const SeenInterval& i : seen) turned_rad += std::abs(i.seen.turn_rad);
  if (out.intervals < kLeastIntervals || turned_rad < kLeastTurn_rad || wheels.empty()) return out;
  Fitter fitter(seen, wheels, believed);
  double coarse = fitter.best_in(range);
  for (int round = 0; round < kRounds; ++round) {
    fitter.weigh(coarse);
    const double again = fitter.best_in({coarse - 0.2, coarse + 0.2});
    if (again == coarse && round > 0) break;
    coarse = again;
  }
  const DelayedFits::Best best = fitter.around(coarse).best();
  const double at_best = fitter.rest(coarse);
  const double at_zero = fitter.rest(0.0);
  out.fit = best.fit;
  out.known = best.fit.known && at_best < 2.0;
  out.delay_s = coarse + best.delay_s;
  out.delay_sigma_s = best.sigma_s;
  const double floor = best.fit.turn_rest > 0.0
                           ? kFloor_m2 * best.fit.turn_rest / std::max(best.fit.turn_rest_m2, 1e-12)
                           : 0.0;
  out.gain = at_zero < 2.0 ? (at_zero + floor) / (at_best + floor)
                           : std::numeric_limits<double>::infinity();
  out.forward_m = fitter.forward_m(out.delay_s);
  return out;
}

}  // namespace zenith::tools
