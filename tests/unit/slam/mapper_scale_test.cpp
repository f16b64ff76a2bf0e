// The metre comes from the wheels: whatever the ceiling's height, and whatever heights are believed
// possible, the map is as large as the wheels say.

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/figure.h"
#include "tests/support/mapper_rig.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

using point_world::MapperRig;
using point_world::PointWorld;

constexpr double kStep_m = 0.05;
constexpr double kVisible = 80.0;  // landmarks in view of an open hall

struct HallDrive {
  double ceiling_m = 6.0;
  double width_m = 100.0;
  double max_height_m = 8.0;
  double wheels_tell = 1.0;  // times the true distance
  double drive_m = 8.0;
  int optimal_proposal = 1;
};

struct HallScale {
  double trajectory = 0.0;  // estimate by truth
  double height = 0.0;      // of the promoted landmarks above the camera, likewise; their median
  MapperCounters counters;
};

double distance(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : points) mean += p / static_cast<double>(points.size());
  double squares = 0.0;
  for (const Eigen::Vector2d& p : points) squares += (p - mean).squaredNorm();
  return std::sqrt(squares);
}

HallScale drive(const HallDrive& hall, std::uint64_t seed) {
  Random random(seed, 3);
  Parameters p;
  p.max_height_m = hall.max_height_m;
  p.optimal_proposal = hall.optimal_proposal;
  const RobotConfig robot;
  const double above_m = hall.ceiling_m - robot.mount.z_m;
  const double view_m = 2.6 * above_m;  // from one side of the image to the other
  const double width_m = std::min(hall.width_m, view_m + 2.0);
  const double length_m = hall.drive_m + 2.0 * view_m;
  const auto count = static_cast<int>(kVisible * length_m / view_m);
  const PointWorld world =
      PointWorld::scatter(random, count, -view_m, length_m - view_m, -0.5 * width_m, 0.5 * width_m,
                          hall.ceiling_m - 0.02, hall.ceiling_m + 0.02);
  auto rig = std::make_unique<MapperRig>(robot, p, seed);
  std::vector<Eigen::Vector2d> estimate;
  std::vector<Eigen::Vector2d> truth;
  for (int i = 0; i * kStep_m < hall.drive_m; ++i) {
    const double turn = 0.003 * std::sin(0.03 * i) - 0.02 * rig->truth().theta_rad;
    rig->drive(i == 0 ? Pose2{} : Pose2{kStep_m, 0.0, turn}, world, random, hall.wheels_tell);
    estimate.push_back(rig->mapper().pose().mean.position());
    truth.push_back(rig->truth().position());
  }
  std::vector<double> heights;
  for (const LandmarkInfo& l : rig->mapper().map().landmarks()) {
    if (l.state != LandmarkState::kPromoted) continue;
    heights.push_back((static_cast<double>(l.z_m) - robot.mount.z_m) / above_m);
  }
  HallScale out;
  out.trajectory = distance(estimate) / distance(truth);
  out.counters = rig->mapper().counters();
  if (heights.empty()) return out;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  out.height = *middle;
  return out;
}

// The worst error of the scale beyond the wheels' own, in percent.
double expect_the_wheels_metre(const HallDrive& hall, std::uint64_t seed) {
  const HallScale scale = drive(hall, seed);
  const double trajectory = 100.0 * (scale.trajectory / hall.wheels_tell - 1.0);
  const double height = 100.0 * (scale.height / hall.wheels_tell - 1.0);
  const auto where = testing::Message()
                     << "ceiling " << hall.ceiling_m << " m, width " << hall.width_m
                     << " m, max_height_m " << hall.max_height_m << ", wheels tell "
                     << hall.wheels_tell << ", seed " << seed;
  EXPECT_LT(std::abs(trajectory), 0.5) << where;
  EXPECT_LT(std::abs(height), 0.5) << where;
  EXPECT_EQ(scale.counters.begun_anew, 0u) << where;
  EXPECT_EQ(scale.counters.slips, 0u) << where;
  EXPECT_GT(scale.counters.landmarks_promoted, 30u) << where;
  return std::max(std::abs(trajectory), std::abs(height));
}

TEST(MapperScale, IsTheWheelsInHallsOfAnyHeight) {
  const TestSeed seed;
  double worst = 0.0;
  std::uint64_t run = 0;
  for (const double ceiling_m : {3.0, 6.0, 12.0}) {
    for (const double factor : {1.05, 1.3, 3.0}) {
      for (const double width_m : {4.0, 100.0}) {
        HallDrive hall;
        hall.ceiling_m = ceiling_m;
        hall.max_height_m = factor * ceiling_m;
        hall.width_m = width_m;
        hall.wheels_tell = 1.0 + 0.004 * (static_cast<double>(run % 3) - 1.0);
        worst = std::max(worst, expect_the_wheels_metre(hall, seed.value() + run++));
      }
    }
  }
  print_figure("mapper: scale in halls of 3 to 12 m at most %.2f %% beyond the wheels'", worst);
}

// With the paper's proposal the particles' weights carry the same priors.
TEST(MapperScale, IsTheWheelsWithThePapersProposal) {
  const TestSeed seed;
  for (std::uint64_t run = 0; run < 2; ++run) {
    HallDrive hall;
    hall.max_height_m = run == 0 ? 6.5 : 18.0;
    hall.optimal_proposal = 0;
    expect_the_wheels_metre(hall, seed.value() + run);
  }
}

}  // namespace
}  // namespace zenith
