#include "slam/fleet/hough.h"

#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/figure.h"
#include "tests/support/seeds.h"
#include "tests/unit/slam/fleet/fleet_world.h"

namespace zenith {
namespace {

using point_world::PeerRig;
using point_world::PointWorld;

constexpr double kDegree = std::numbers::pi / 180.0;

struct Scene {
  PointWorld world;
  Pose2 T_world_robot;
  Pose2 T_peer_world;
  std::unique_ptr<PeerRig> peer;
  ObservedFrame frame;
  OverlapMatches matches;

  // `centre_m`: where in the peer's frame the scene lies, 13 m to each side.
  explicit Scene(Random& random, double centre_m = 25.0) {
    world = PointWorld::scatter(random, 400, -10.0, 10.0, -10.0, 10.0);
    T_world_robot = {random.uniform(-6.0, 6.0), random.uniform(-6.0, 6.0),
                     random.uniform(-3.1, 3.1)};
    T_peer_world = {centre_m + random.uniform(-13.0, 13.0), centre_m + random.uniform(-13.0, 13.0),
                    random.uniform(-3.1, 3.1)};
    peer = std::make_unique<PeerRig>(world, T_peer_world);
    observe_near(world, T_world_robot, 3.0, 0.03, random, frame);
  }
  Pose2 T_peer_robot() const { return T_peer_world * T_world_robot; }

  // Every observed landmark gets one match: the right one, or any other with any direction.
  void match(Random& random, double wrong) {
    matches.clear();
    for (std::size_t i = 0; i < frame.size(); ++i) {
      OverlapMatch m;
      m.observed = static_cast<int>(i);
      m.ncc = 0.9F;
      m.weight = 1.0F;
      if (random.uniform() < wrong) {
        m.peer_slot = static_cast<int>(random.below(400));
        m.heading_rad = static_cast<float>(random.uniform(-3.14, 3.14));
      } else {
        m.peer_slot = frame[i].slot;
        m.heading_rad = static_cast<float>(
            wrap_angle(T_peer_robot().theta_rad + 5.0 * kDegree * random.normal()));
      }
      matches.push_back(m);
    }
  }
};

struct Rig {
  HoughSearch search;
  ArenaBlock block{[this](Arena& arena) { search.layout(arena); }};
  PlaceFixes fixes;

  const PlaceFixes& find(const Scene& scene) {
    OverlapMatches matches = scene.matches;
    for (OverlapMatch& m : matches) {
      m.from_robot_m = scene.frame[static_cast<std::size_t>(m.observed)].from_robot_m;
      m.landmark_m = scene.peer->map[m.peer_slot].xy();
    }
    search.find_places(matches, {}, fixes);
    return fixes;
  }
};

struct Accuracy {
  int trials = 0;
  int found = 0;  // to 0.1 m and 2 degrees
  double worst_m = 0.0;
  double worst_rad = 0.0;
};

// Half of the matches wrong; scenes in which fewer than 8 right ones are left do not count.
Accuracy measure(Random& random, double centre_m) {
  Rig rig;
  Accuracy out;
  for (int trial = 0; trial < 100; ++trial) {
    Scene scene(random, centre_m);
    scene.match(random, 0.5);
    int right = 0;
    for (const OverlapMatch& m : scene.matches) {
      right += m.peer_slot == scene.frame[static_cast<std::size_t>(m.observed)].slot ? 1 : 0;
    }
    if (right < 8) continue;
    ++out.trials;
    const PlaceFixes& fixes = rig.find(scene);
    if (fixes.empty()) continue;
    const Pose2 truth = scene.T_peer_robot();
    const Pose2& got = fixes[0].T_peer_robot;
    const double away = (got.position() - truth.position()).norm();
    const double turn = std::abs(wrap_angle(got.theta_rad - truth.theta_rad));
    out.found += away < 0.1 && turn < 2.0 * kDegree ? 1 : 0;
    out.worst_m = std::max(out.worst_m, away);
    out.worst_rad = std::max(out.worst_rad, turn);
  }
  return out;
}

TEST(Hough, FindsTheRobotAmongWrongMatches) {
  const TestSeed seed;
  Random random(seed.value());
  const Accuracy a = measure(random, 25.0);
  print_figure("hough: half of the matches wrong, %d of %d found, at most %.3f m and %.2f deg off",
               a.found, a.trials, a.worst_m, a.worst_rad / kDegree);
  EXPECT_GT(a.trials, 80);
  EXPECT_EQ(a.found, a.trials);
}

// Places outside the grid of 51.2 m share its cells.
TEST(Hough, FindsTheRobotAnywhereInThePlane) {
  const TestSeed seed;
  Random random(seed.value());
  for (int n = 0; n < 20; ++n) {
    const Accuracy a = measure(random, -80.0 + 10.0 * n);
    EXPECT_EQ(a.found, a.trials) << "around " << -80 + 10 * n << " m";
  }
}

TEST(Hough, FindsNothingAmongWrongMatchesAlone) {
  const TestSeed seed;
  Random random(seed.value());
  Rig rig;
  int found = 0;
  for (int trial = 0; trial < 100; ++trial) {
    Scene scene(random);
    scene.match(random, 1.0);
    found += static_cast<int>(rig.find(scene).size());
  }
  EXPECT_EQ(found, 0);
}

TEST(Hough, NeedsEnoughMatches) {
  const TestSeed seed;
  Random random(seed.value());
  Rig rig;
  Scene scene(random);
  scene.matches.clear();
  EXPECT_TRUE(rig.find(scene).empty());
  scene.match(random, 0.0);
  scene.matches.shrink_to(4);
  EXPECT_TRUE(rig.find(scene).empty());
}

// Two places that look the same are both reported: the sequence decides, not one frame.
TEST(Hough, ReportsBothOfTwoEqualPlaces) {
  const TestSeed seed;
  Random random(seed.value());
  Rig rig;
  Scene scene(random);
  const std::size_t count = scene.frame.size();
  const Pose2 away = {6.0, 4.0, 0.0};
  for (std::size_t i = 0; i < count; ++i) {
    const auto& l = scene.world.landmarks[static_cast<std::size_t>(scene.frame[i].slot)];
    LandmarkRecord twin =
        record_of(l, 10'000 + static_cast<std::uint32_t>(i), 1, scene.T_peer_world);
    twin.x_m += static_cast<float>(away.x_m);
    twin.y_m += static_cast<float>(away.y_m);
    scene.peer->map.apply(twin);
  }
  scene.match(random, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    OverlapMatch twin = scene.matches[i];
    twin.peer_slot = static_cast<int>(400 + i);
    scene.matches.push_back(twin);
  }
  const PlaceFixes& fixes = rig.find(scene);
  const Eigen::Vector2d truth = scene.T_peer_robot().position();
  bool first = false;
  bool second = false;
  for (const PlaceFix& fix : fixes) {
    first |= (fix.T_peer_robot.position() - truth).norm() < 0.1;
    second |= (fix.T_peer_robot.position() - truth - away.position()).norm() < 0.1;
  }
  EXPECT_TRUE(first);
  EXPECT_TRUE(second);
}

}  // namespace
}  // namespace zenith
