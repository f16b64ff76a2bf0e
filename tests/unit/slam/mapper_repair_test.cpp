// Numbers of the filter are broken on purpose: each is repaired, counted, and the robot maps on.

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "slam/bounds.h"
#include "tests/support/mapper_rig.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

using point_world::MapperRig;
using point_world::PointWorld;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

Parameters small_parameters() {
  Parameters p;
  p.particles = 60;
  p.pixel_sigma_px = 0.5;
  p.distance_noise_per_sqrt_m = 0.005;
  return p;
}

class MapperRepair : public testing::Test {
 protected:
  // A robot that has mapped for a metre and a half.
  MapperRepair()
      : random_(seed_.value()),
        world_(PointWorld::scatter(random_, 900, -4.0, 14.0, -4.0, 4.0)),
        rig_(std::make_unique<MapperRig>(RobotConfig{}, small_parameters(), seed_.value())) {
    rig_->drive({}, world_, random_);
    drive(15);
    EXPECT_EQ(repairs().total(), 0u) << "nothing is broken yet";
    EXPECT_GT(promoted(), 30);
  }

  void drive(int steps) {
    for (int i = 0; i < steps; ++i) rig_->drive({0.1, 0.0, 0.0}, world_, random_);
  }
  Mapper& mapper() { return rig_->mapper(); }
  const RepairCounters& repairs() { return mapper().counters().repairs; }
  const Particles& particles() { return mapper().particles(); }

  int promoted() {
    int count = 0;
    for (const LandmarkInfo& l : mapper().map().landmarks()) {
      count += l.state == LandmarkState::kPromoted ? 1 : 0;
    }
    return count;
  }
  // A promoted landmark that the next frame will show.
  int landmark_in_view() {
    int best = -1;
    double nearest = 0.0;
    for (const Candidate& c : mapper().candidates()) {
      const LandmarkInfo& l = mapper().map().info(c.slot);
      if (!c.inlier || l.state != LandmarkState::kPromoted) continue;
      if (best >= 0 && c.m.norm() > nearest) continue;
      best = c.slot;
      nearest = c.m.norm();
    }
    EXPECT_GE(best, 0) << "no landmark above the robot";
    return std::max(best, 0);
  }

  void expect_sound() {
    EXPECT_TRUE(is_usable(mapper().pose().mean));
    EXPECT_TRUE(is_covariance(mapper().pose().covariance));
    double sum = 0.0;
    for (int i = 0; i < particles().count; ++i) {
      EXPECT_TRUE(is_usable(particles().pose(i))) << i;
      sum += particles().weight[static_cast<std::size_t>(i)];
    }
    EXPECT_NEAR(sum, 1.0, 1e-9);
    for (const LandmarkInfo& l : mapper().map().landmarks()) {
      if (l.state != LandmarkState::kPromoted) continue;
      EXPECT_TRUE(l.position_m().allFinite() && l.covariance().allFinite()) << l.id;
    }
  }
  // The next two metres are as long as they are, with the map that was there.
  void expect_to_map_on() {
    drive(5);
    const Eigen::Vector3d before = rig_->error();
    drive(20);
    expect_sound();
    EXPECT_LT((rig_->error() - before).head<2>().norm(), 0.05);
    EXPECT_LT(std::abs((rig_->error() - before).z()), 0.02);
    EXPECT_GT(promoted(), 30);
  }

  const TestSeed seed_;
  Random random_;
  PointWorld world_;
  std::unique_ptr<MapperRig> rig_;
};

TEST_F(MapperRepair, SoundNumbersAreLeftAlone) {
  drive(60);
  EXPECT_EQ(repairs().total(), 0u);
  expect_sound();
}

TEST_F(MapperRepair, ALogWeightThatIsNoNumberIsNone) {
  for (const double bad : {kNan, kInfinite}) {
    const auto before = repairs().weights_zeroed;
    particles().log_weight[7] = bad;
    drive(1);
    EXPECT_EQ(repairs().weights_zeroed, before + 1);
    expect_sound();
  }
  expect_to_map_on();
}

TEST_F(MapperRepair, AWeightThatIsNoNumberIsComputedAgain) {
  particles().weight[7] = kNan;
  drive(1);
  EXPECT_EQ(repairs().weights_zeroed, 1u);
  EXPECT_EQ(repairs().landmarks_dropped, 0u) << "one weight must not cost the map";
  expect_to_map_on();
}

TEST_F(MapperRepair, WithoutAnyWeightAllAreAlike) {
  for (double& w : particles().log_weight) w = -kInfinite;
  drive(1);
  EXPECT_EQ(repairs().weights_equalised, 1u);
  expect_to_map_on();
}

TEST_F(MapperRepair, AParticleWithoutAPoseMovesToTheHeaviest) {
  particles().x_m[3] = kNan;
  particles().theta_rad[11] = kInfinite;
  particles().y_m[12] = 1e9;
  drive(1);
  EXPECT_EQ(repairs().particles_moved, 3u);
  EXPECT_EQ(repairs().poses_reset, 0u);
  expect_to_map_on();
}

TEST_F(MapperRepair, WithoutAnyPoseAllStandAroundTheLastMean) {
  for (double& x : particles().x_m) x = kNan;
  drive(1);
  EXPECT_EQ(repairs().poses_reset, 1u);
  EXPECT_EQ(repairs().maps_reset, 0u);
  EXPECT_LT(rig_->error().head<2>().norm(), 0.3);
  expect_to_map_on();
}

TEST_F(MapperRepair, AMapWithWhichPosesBreakAgainAndAgainIsReset) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(repairs().maps_reset, 0u);
    for (double& x : particles().x_m) x = kNan;
    drive(1);
  }
  EXPECT_EQ(repairs().poses_reset, 3u);
  EXPECT_EQ(repairs().maps_reset, 1u);
  EXPECT_EQ(mapper().counters().begun_anew, 1u);
  drive(10);
  expect_to_map_on();
}

// In one particle, in any component.
TEST_F(MapperRepair, ALandmarkWithARowThatIsNoNumberIsDropped) {
  std::uint64_t dropped = 0;
  for (const int row : {0, 1, 2, 3, 4, 5, 6, 7, 8}) {
    const int slot = landmark_in_view();
    const std::uint32_t id = mapper().map().info(slot).id;
    const LandmarkRows l = mapper().map().rows(slot);
    float* const rows[] = {l.ax, l.ay, l.rho, l.pxx, l.pxy, l.pxr, l.pyy, l.pyr, l.prr};
    rows[row][row] = row % 2 == 0 ? kNanF : std::numeric_limits<float>::infinity();
    drive(1);
    EXPECT_EQ(repairs().landmarks_dropped, ++dropped) << row;
    for (const LandmarkInfo& other : mapper().map().landmarks()) {
      EXPECT_FALSE(other.state != LandmarkState::kFree && other.id == id) << row;
    }
    expect_sound();
  }
  EXPECT_EQ(repairs().total(), dropped);
  expect_to_map_on();
}

TEST_F(MapperRepair, ALandmarkWithoutAVarianceIsDropped) {
  const int slot = landmark_in_view();
  const LandmarkRows l = mapper().map().rows(slot);
  for (int i = 0; i < particles().count; ++i) l.pxx[i] = -1.0F;
  drive(1);
  EXPECT_EQ(repairs().landmarks_dropped, 1u);
  expect_to_map_on();
}

// Where no frame shows it, the turn through all promoted landmarks finds it.
TEST_F(MapperRepair, ALandmarkBeyondTheBoundsIsDropped) {
  const int slot = landmark_in_view();
  const LandmarkRows l = mapper().map().rows(slot);
  for (int i = 0; i < particles().count; ++i) l.ax[i] = 1e30F;
  drive(60);
  EXPECT_EQ(repairs().landmarks_dropped, 1u);
  expect_sound();
}

TEST_F(MapperRepair, AnAnchorThatIsNoNumberTakesItsLandmarksAlong) {
  const int slot = landmark_in_view();
  const std::int32_t anchor = mapper().map().info(slot).anchor;
  // Anchors are read alone: the test writes to one all the same.
  *const_cast<float*>(mapper().map().rows(slot).anchor_x) = kNanF;
  drive(40);
  EXPECT_GE(repairs().landmarks_dropped, 1u);
  EXPECT_EQ(repairs().total(), repairs().landmarks_dropped);
  for (const LandmarkInfo& l : mapper().map().landmarks()) {
    if (l.state == LandmarkState::kPromoted && l.anchor == anchor) {
      EXPECT_TRUE(l.position_m().allFinite());
    }
  }
  expect_to_map_on();
}

TEST_F(MapperRepair, ASensitivityThatIsNoNumberCostsItsLandmarkAlone) {
  const int slot = landmark_in_view();
  mapper().map().by_calibration(slot)(0, 0) = kNan;
  drive(2);
  EXPECT_EQ(repairs().landmarks_dropped, 1u);
  EXPECT_EQ(repairs().calibrations_reset, 0u);
  EXPECT_EQ(repairs().total(), 1u);
  expect_to_map_on();
}

TEST_F(MapperRepair, TravelThatIsNoNumberIsNone) {
  for (const WheelTravel bad :
       {WheelTravel{kNan, 0.0}, WheelTravel{0.1, kInfinite}, WheelTravel{1e300, -1e300}}) {
    const auto before = repairs().travels_refused;
    world_.observe(rig_->truth(), mapper().robot(), rig_->view().pinhole(), 0.5, random_,
                   rig_->features());
    mapper().update(motion_increment({}, bad, {}), rig_->features(), rig_->view());
    EXPECT_EQ(repairs().travels_refused, before + 1);
    expect_sound();
  }
  expect_to_map_on();
}

TEST_F(MapperRepair, CornersThatAreNoNumbersMakeNoLandmarks) {
  world_.observe(rig_->truth(), mapper().robot(), rig_->view().pinhole(), 0.5, random_,
                 rig_->features());
  // The others show that the robot is where it is taken to be.
  for (std::size_t k = 0; k < rig_->features().size(); k += 3) {
    Feature& f = rig_->features()[k];
    f.zx = f.zy = kNanF;
  }
  mapper().update(motion_increment({}, {0.1, 0.1}, {}), rig_->features(), rig_->view());
  EXPECT_GT(repairs().landmarks_dropped, 0u);
  expect_sound();
  drive(10);
  expect_to_map_on();
}

}  // namespace
}  // namespace zenith
