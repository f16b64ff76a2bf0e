#include "slam/filter/noise_scale.h"

#include <algorithm>
#include <numbers>

namespace zenith {
namespace {

constexpr double kMedian = 2.0 * std::numbers::ln2;  // of chi squared with two degrees of freedom
constexpr int kFewMatches = 8;
// Steps of log kappa_1 for each unit of (share above the median - 1/2).
constexpr double kFirstGain = 1.2;
constexpr double kLastGain = 0.06;
constexpr double kLeastKappa = 0.1;
constexpr double kPairsBefore = 100.0;  // with which the memory is begun
constexpr double kPairsKept = 5000.0;   // that it looks back on
constexpr double kMostMemory = 0.85;

}  // namespace

void NoiseScale::add(double squared_innovation) {
  ++matches_;
  above_ += squared_innovation > kMedian ? 1 : 0;
}

void NoiseScale::add_pair(double residual, double last_residual) {
  ++pairs_;
  agreeing_ += (residual > 0.0) == (last_residual > 0.0) ? 1 : 0;
}

bool NoiseScale::end_frame() {
  const int matches = matches_;
  const double off = matches == 0 ? 0.0 : static_cast<double>(above_) / matches - 0.5;
  const int pairs = pairs_;
  const double sign = pairs == 0 ? 0.0 : 2.0 * static_cast<double>(agreeing_) / pairs - 1.0;
  matches_ = above_ = pairs_ = agreeing_ = 0;
  if (matches < kFewMatches) return false;
  ++frames_;
  const double gain = std::max(kFirstGain / (1.0 + 0.05 * frames_), kLastGain);
  kappa_1_ = std::clamp(kappa_1_ * std::exp(gain * off), kLeastKappa, kMostNoise * kMostNoise);
  if (pairs > 0) {
    pairs_weight_ = std::min(pairs_weight_ + pairs, kPairsKept);
    mean_sign_ += (sign - mean_sign_) * pairs / (kPairsBefore + pairs_weight_);
    memory_ = std::clamp(std::sin(0.5 * std::numbers::pi * mean_sign_), 0.0, kMostMemory);
  }
  const double before = kappa_;
  kappa_ = std::clamp(kappa_1_ * (1.0 + memory_) / (1.0 - memory_), 1.0, kMostNoise * kMostNoise);
  return kappa_ != before;
}

}  // namespace zenith
