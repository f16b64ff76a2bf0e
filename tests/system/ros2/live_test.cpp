// zenith-ros2 beside a real daemon with a simulated robot.

#include <cmath>
#include <map>

#include "tests/system/ros2/bridge_rig.h"
#include "tests/system/sim_daemon.h"

namespace zenith {
namespace {

struct At {
  std::int64_t ns = 0;
  Pose2 pose;
};

class LiveBridge : public BridgeRig {
 protected:
  void SetUp() override {
    BridgeRig::SetUp();
    ASSERT_TRUE(daemon_.start()) << daemon_.log();
  }
  SimDaemon daemon_{folder_.path(), "r1", "enabled = false\n"};
};

TEST_F(LiveBridge, OdomIsContinuousAndTheChainEndsAtThePose) {
  const std::string socket = (folder_.path() / "r1.sock").string();
  ASSERT_TRUE(start_bridge({socket}, [] { return true; }));
  const auto odom = listener_->subscribe("rt/odom", ros2::kOdometry, {100});
  const auto pose = listener_->subscribe("rt/pose", ros2::kPoseWithCovarianceStamped, {100});
  const auto tf = listener_->subscribe("rt/tf", ros2::kTransforms, {100});
  const auto map = listener_->subscribe("rt/landmarks", ros2::kPointCloud, {1, true});

  // The robot drives: half a metre by its wheels, in steps that it can drive.
  std::vector<At> path;
  ASSERT_TRUE(take_until<OdometryMessage>(odom, [&](const OdometryMessage& m) {
    const auto& p = m.pose.pose.position;
    path.push_back({ns_of(m.header), pose_of(m.pose.pose.orientation, p.x, p.y)});
    EXPECT_GE(m.pose.covariance[0], 0.0);
    return std::hypot(p.x, p.y) > 0.5;
  }));
  ASSERT_GE(path.size(), 3u);
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double seconds = static_cast<double>(path[i].ns - path[i - 1].ns) * 1e-9;
    const Pose2 step = path[i - 1].pose.inverse() * path[i].pose;
    EXPECT_GT(seconds, 0.0);
    EXPECT_LT(std::hypot(step.x_m, step.y_m), 1.5 * seconds + 0.01) << "faster than it drives";
  }

  // The transforms of a frame lead to its pose.
  std::map<std::int64_t, Pose2> chains;
  ASSERT_TRUE(take_until<TransformsMessage>(tf, [&](const TransformsMessage& m) {
    EXPECT_EQ(m.transforms._length, 2u);
    Pose2 chain;
    for (std::uint32_t i = 0; i < m.transforms._length; ++i) {
      const auto& t = m.transforms._buffer[i].transform;
      chain = chain * pose_of(t.rotation, t.translation.x, t.translation.y);
    }
    chains[ns_of(m.transforms._buffer[0].header)] = chain;
    return chains.size() == 3;
  }));
  int compared = 0;
  ASSERT_TRUE(take_until<PoseMessage>(pose, [&](const PoseMessage& m) {
    const auto found = chains.find(ns_of(m.header));
    if (found == chains.end()) return false;
    EXPECT_NEAR(found->second.x_m, m.pose.pose.position.x, 1e-6);
    EXPECT_NEAR(found->second.y_m, m.pose.pose.position.y, 1e-6);
    return ++compared == 3;
  }));
  EXPECT_TRUE(take_until<CloudMessage>(map, [](const CloudMessage& m) { return m.width > 20; }));
}

}  // namespace
}  // namespace zenith
