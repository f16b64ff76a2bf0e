#pragma once
// The particle filter of the core with another sensor: range and bearing to known landmarks.
//
// Particles, weights, resampling, ancestry, rows and the proposals are slam/filter's; this file
// brings the observation model and a landmark of two states, L = (x, y), for each particle:
//
//   d = R(theta)^T (L - x),   range = |d|,   bearing = atan2(d_y, d_x)
//
// Linearised: H = d(range, bearing)/dL; in the body, xi = (forward, left, turn) moves d by
// (-1, 0, d_y; 0, -1, -d_x) xi.

#include <array>
#include <cstddef>
#include <vector>

#include "platform/base/random.h"
#include "slam/counters.h"
#include "slam/filter/ancestry.h"
#include "slam/filter/particles.h"
#include "slam/filter/proposal.h"
#include "slam/filter/rows.h"
#include "tests/support/range_bearing_data.h"

namespace zenith {

struct RangeBearingSettings {
  int particles = 200;
  bool optimal_proposal = true;
  double resample_fraction = 0.5;
  // Standard deviations; of the motion per square root of a metre, a radian and a second.
  double forward_per_sqrt_m = 0.05;
  double lateral_per_sqrt_m = 0.01;
  double turn_per_sqrt_rad = 0.15;
  double turn_per_sqrt_m = 0.07;
  double range_sigma_m = 0.12;
  double range_sigma_per_m = 0.03;
  double bearing_sigma_rad = 0.05;
  double gate_d2 = 13.8;  // 2 degrees of freedom, 99.9 %
  int young = 3;          // observations below which a landmark is doubted, not a measurement
};

class RangeBearingFilter {
 public:
  static constexpr int kLandmarks = 21;  // slots by subject

  RangeBearingFilter(const RangeBearingSettings& settings, std::uint64_t seed);

  // Odometry of the next `dt_s`; collected until the next observe().
  void drive(double forward_mps, double turn_radps, double dt_s);

  // All measurements of one time. Unknown subjects start as landmarks.
  void observe(const std::vector<RangeBearing>& measurements);

  // At the last observe().
  Pose2 pose() const { return estimate_pose(particles_).mean; }

  struct Landmark {
    int subject = 0;
    Eigen::Vector2d mean_m = Eigen::Vector2d::Zero();
    Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Zero();
    int observations = 0;
  };
  std::vector<Landmark> landmarks();

  int resamplings() const { return static_cast<int>(ancestry_.generation()); }
  int gated() const { return gated_; }

 private:
  static constexpr int kRows = 5;  // x y Pxx Pxy Pyy

  void layout(Arena& arena);
  std::vector<RangeBearing> known_and_plausible(const std::vector<RangeBearing>& measurements);
  double distance_to_all(const RangeBearing& z) const;
  void move_optimal(const std::vector<RangeBearing>& known);
  void move_and_weigh(const std::vector<RangeBearing>& known);
  void update(const RangeBearing& z);
  void start(const RangeBearing& z);
  void resample();
  double range_sigma(const RangeBearing& z) const {
    return settings_.range_sigma_m + settings_.range_sigma_per_m * z.range_m;
  }

  struct Innovation;
  Innovation innovation(const RangeBearing& z, int particle) const;

  RangeBearingSettings settings_;
  Random random_;
  std::vector<std::byte> memory_;
  Particles particles_;
  RepairCounters repairs_;
  Ancestry ancestry_;
  RowStore<kRows> rows_;
  ProposalRows proposal_;
  std::array<int, kLandmarks> observations_ = {};
  MotionIncrement motion_;
  int gated_ = 0;
};

}  // namespace zenith
