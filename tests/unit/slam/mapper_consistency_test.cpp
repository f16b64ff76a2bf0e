// Is the filter as sure as it may be? NEES of the pose: e^T P^-1 e over (x, y, theta), which has
// mean 3 when the covariance is honest (Bar-Shalom, Li, Kirubarajan, "Estimation with Applications
// to Tracking and Navigation", 5.4).

#include <cmath>
#include <memory>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "tests/support/figure.h"
#include "tests/support/mapper_rig.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

using point_world::MapperRig;
using point_world::PointWorld;

struct Consistency {
  double nees = 0.0;      // mean over the runs
  Eigen::Vector3d rms;    // true errors
  Eigen::Vector3d sigma;  // stated ones
};

// Independent worlds, drives and filters; the noise is what the parameters say; the calibration is
// right and not learned. At the end of `way_m` in steps of 5 cm.
// `stated`: the covariance that the step states, not the spread of the particles alone; `noisier`:
// corners, than the parameters say.
Consistency measure(std::uint64_t seed, int runs, int particles, double way_m, bool stated = false,
                    double noisier = 1.0) {
  Parameters p;
  p.particles = particles;
  p.pixel_sigma_px = 0.5;
  p.tilt_sigma_deg = 0.0;
  RobotConfig robot;
  robot.mount.x_m = 0.05;
  robot.mount.y_m = -0.02;
  Consistency out = {0.0, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (int run = 0; run < runs; ++run) {
    const auto k = static_cast<std::uint64_t>(run);
    Random random(seed + k);
    const PointWorld world = PointWorld::scatter(random, 200, -5.0, way_m + 5.0, -5.0, 5.0);
    auto rig = std::make_unique<MapperRig>(robot, p, seed + 1000 + k);
    rig->drive({}, world, random, 1.0, noisier);
    for (int i = 0; i < std::lround(way_m / 0.05); ++i) {
      rig->drive({0.05, 0.0, 0.002 * std::sin(0.05 * i)}, world, random, 1.0, noisier);
    }
    const Eigen::Vector3d e = rig->error();
    const Eigen::Matrix3d P =
        stated ? rig->mapper().pose_covariance() : rig->mapper().pose().covariance;
    out.nees += e.dot(P.ldlt().solve(e)) / runs;
    out.rms += e.cwiseAbs2() / runs;
    out.sigma += P.diagonal() / runs;
  }
  out.rms = out.rms.cwiseSqrt();
  out.sigma = out.sigma.cwiseSqrt();
  return out;
}

void print(const char* what, const Consistency& c) {
  print_figure("mapper NEES %s: %.2f of 3; error %.1f %.1f mm %.2f mrad, stated %.1f %.1f mm %.2f",
               what, c.nees, 1e3 * c.rms.x(), 1e3 * c.rms.y(), 1e3 * c.rms.z(), 1e3 * c.sigma.x(),
               1e3 * c.sigma.y(), 1e3 * c.sigma.z());
}

// 30 runs of 3 degrees of freedom: 30 NEES has chi squared's distribution with 90 degrees, of which
// 95 % lie within [65.6, 118.1]. The band holds over the first two metres with 800 particles, while
// the set still covers what it does not know; see the next test.
TEST(MapperConsistency, NeesIsWithinItsBandOverTwoMetres) {
  const TestSeed seed;
  constexpr int kRuns = 30;
  const Consistency c = measure(seed.value(), kRuns, 800, 2.0);
  print("after 2 m, 800 particles", c);
  EXPECT_GT(c.nees, 65.6 / kRuns);
  EXPECT_LT(c.nees, 118.1 / kRuns);
}

// Over a longer way the filter is surer than it may be. The map's scale is fixed by the odometry of
// the first metres, every particle carries its own, and resampling leaves fewer and fewer of them:
// the known degeneracy of particle filters with static parameters (Bailey, Nieto, Nebot,
// "Consistency of the FastSLAM algorithm", ICRA 2006). More particles put it off. Stated as
// figures; the bounds only hold what is reached.
TEST(MapperConsistency, IsTooSureOverALongerWay) {
  const TestSeed seed;
  const Consistency few = measure(seed.value(), 12, 200, 6.0);
  print("after 6 m, 200 particles", few);
  EXPECT_LT(few.rms.head<2>().norm(), 0.003 * 6.0);
  EXPECT_LT(few.rms.z(), 0.003);
}

// What the step states makes up for it: the drift that the particles do not know, and corners that
// are noisier than the parameters say.
TEST(MapperConsistency, StatedCovariancesHoldOverALongerWay) {
  const TestSeed seed;
  const Consistency as_said = measure(seed.value(), 12, 200, 6.0, true);
  print("stated, after 6 m, 200 particles", as_said);
  EXPECT_LT(as_said.nees, 6.0);
  EXPECT_GT(as_said.nees, 0.1);
  const Consistency noisier = measure(seed.value() + 100, 12, 200, 6.0, true, 4.0);
  print("stated, corners four times as noisy", noisier);
  EXPECT_LT(noisier.nees, 6.0);
  EXPECT_GT(noisier.nees, 0.1);
}

TEST(MapperConsistency, CornersThatAreNoisierThanSaidAreFoundToBeSo) {
  const TestSeed seed;
  for (const double noisier : {1.0, 2.0, 4.0}) {
    Parameters p;
    p.pixel_sigma_px = 0.35;
    Random random(seed.value());
    const PointWorld world = PointWorld::scatter(random, 200, -5.0, 9.0, -5.0, 5.0);
    auto rig = std::make_unique<MapperRig>(RobotConfig{}, p, seed.value() + 7);
    for (int i = 0; i < 80; ++i) {
      rig->drive(i == 0 ? Pose2{} : Pose2{0.05, 0.0, 0.001}, world, random, 1.0, noisier);
    }
    print_figure("corners %.1f times as noisy as said: found %.2f", noisier,
                 rig->mapper().corner_sigma_px() / p.pixel_sigma_px);
    EXPECT_NEAR(rig->mapper().corner_sigma_px() / p.pixel_sigma_px, noisier, 0.25 * noisier);
  }
}

}  // namespace
}  // namespace zenith
