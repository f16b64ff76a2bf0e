// zenith-ros2 as a program, seen by another participant that asks as ROS 2's nodes do.

#include <cmath>
#include <cstring>
#include <map>

#include <gmock/gmock.h>

#include "tests/system/ros2/bridge_rig.h"

namespace zenith {
namespace {

using ros2::kDiagnostics;
using ros2::kFloat;
using ros2::kOdometry;
using ros2::kPointCloud;
using ros2::kPoseWithCovarianceStamped;
using ros2::kTransforms;

// The transforms of one message by "parent>child".
std::map<std::string, Pose2> by_name(const TransformsMessage& message) {
  std::map<std::string, Pose2> out;
  for (std::uint32_t i = 0; i < message.transforms._length; ++i) {
    const auto& t = message.transforms._buffer[i];
    const auto& v = t.transform.translation;
    out[std::string(t.header.frame_id) + ">" + t.child_frame_id] =
        pose_of(t.transform.rotation, v.x, v.y);
  }
  return out;
}

void expect_pose(const Pose2& found, const Pose2& expected) {
  EXPECT_NEAR(found.x_m, expected.x_m, 1e-6);
  EXPECT_NEAR(found.y_m, expected.y_m, 1e-6);
  EXPECT_NEAR(wrap_angle(found.theta_rad - expected.theta_rad), 0.0, 1e-6);
}

TEST_F(BridgeRig, OdometryAndPoseAreThoseOfTheFrameAtItsMoment) {
  ASSERT_TRUE(start(1));
  robot().say(hello_line("anna"));
  const auto odom = listener_->subscribe("rt/odom", kOdometry);
  const auto pose = listener_->subscribe("rt/pose", kPoseWithCovarianceStamped);
  ASSERT_TRUE(hears_motion({odom, pose}));
  robot().say(pose_line(2'000'000'005, {1, 2, 0.5}, {3, 4, -2.5}));
  ASSERT_TRUE(take_until<OdometryMessage>(odom, [](const OdometryMessage& m) {
    if (is_probe(m.header)) return false;
    EXPECT_STREQ(m.header.frame_id, "odom");
    EXPECT_STREQ(m.child_frame_id, "base_link");
    EXPECT_EQ(ns_of(m.header), kOffset_ns + 2'000'000'005);
    const auto& p = m.pose.pose.position;
    expect_pose(pose_of(m.pose.pose.orientation, p.x, p.y), {3, 4, -2.5});
    EXPECT_EQ(m.pose.covariance[0], 0.1);
    EXPECT_EQ(m.pose.covariance[5], 0.3);
    EXPECT_EQ(m.pose.covariance[35], 0.6);
    EXPECT_EQ(m.twist.twist.linear.x, 0.5);
    EXPECT_EQ(m.twist.twist.angular.z, -0.25);
    EXPECT_EQ(m.twist.covariance[7], 2.0);
    return true;
  }));
  ASSERT_TRUE(take_until<PoseMessage>(pose, [](const PoseMessage& m) {
    if (is_probe(m.header)) return false;
    EXPECT_STREQ(m.header.frame_id, "map");
    EXPECT_EQ(ns_of(m.header), kOffset_ns + 2'000'000'005);
    const auto& p = m.pose.pose.position;
    expect_pose(pose_of(m.pose.pose.orientation, p.x, p.y), {1, 2, 0.5});
    EXPECT_EQ(m.pose.covariance[6], 0.02);
    EXPECT_EQ(m.pose.covariance[31], 0.05);
    return true;
  }));
}

// REP-105: a closed loop moves the map's frame against odom, and odom not at all.
TEST_F(BridgeRig, TheMapJumpsAndOdomDoesNot) {
  ASSERT_TRUE(start(1));
  robot().say(hello_line("anna"));
  const auto tf = listener_->subscribe("rt/tf", kTransforms, {100});
  ASSERT_TRUE(hears_motion({tf}));
  const Pose2 before = {5.0, 1.0, 0.4};
  const Pose2 after = {5.3, 0.6, 0.5};  // with 1 cm of driving
  robot().say(pose_line(1'000'000'000, before, {5.0, 1.0, 0.4}));
  robot().say(pose_line(1'100'000'000, after, {5.01, 1.0, 0.4}));
  std::vector<std::map<std::string, Pose2>> told;
  ASSERT_TRUE(take_until<TransformsMessage>(tf, [&](const TransformsMessage& m) {
    if (!is_probe(m.transforms._buffer[0].header)) told.push_back(by_name(m));
    return told.size() == 2;
  }));
  expect_pose(told[0].at("odom>base_link"), {5.0, 1.0, 0.4});
  expect_pose(told[1].at("odom>base_link"), {5.01, 1.0, 0.4});
  expect_pose(told[0].at("map>odom"), {});
  EXPECT_GT(std::abs(told[1].at("map>odom").theta_rad), 0.09);
  expect_pose(told[1].at("map>odom") * told[1].at("odom>base_link"), after);
}

TEST_F(BridgeRig, WhoComesLaterGetsMapAndMergedMaps) {
  ASSERT_TRUE(start(1));
  robot().say(hello_line("anna"));
  const auto early = listener_->subscribe("rt/tf_static", kTransforms, {100, true});
  ASSERT_TRUE(listener_->matched(early));
  robot().say(pose_line(4'000'000'000, {}, {}));
  robot().say(landmarks_line(-1, {7, 1.5, -2.5, 3.0, 1e-4, 0, 1e-4, 4e-4, 9}));
  robot().say(landmarks_line(0, {8, 4, 5, 2, 1e-4, 0, 1e-4, 4e-4, 9}));
  robot().say(alignment_line("bert", 0, "merged", {10, -1, 1.0}));
  robot().say(radio_line());
  ASSERT_TRUE(take_until<TransformsMessage>(
      early, [](const TransformsMessage& m) { return m.transforms._length == 1; }));

  Listener late;
  const auto fixed = late.subscribe("rt/tf_static", kTransforms, {100, true});
  const auto map = late.subscribe("rt/landmarks", kPointCloud, {5, true});
  const auto other = late.subscribe("rt/peers/bert/landmarks", kPointCloud, {5, true});
  ASSERT_TRUE(take_until<TransformsMessage>(fixed, [](const TransformsMessage& m) {
    const auto told = by_name(m);
    EXPECT_EQ(told.size(), 1u);
    expect_pose(told.at("map>bert/map"), {10, -1, 1.0});
    return true;
  }));
  ASSERT_TRUE(take_until<CloudMessage>(map, [](const CloudMessage& m) {
    EXPECT_STREQ(m.header.frame_id, "map");
    EXPECT_EQ(ns_of(m.header), kOffset_ns + 4'000'000'000);
    EXPECT_EQ(m.width, 1u);
    float x = 0;
    std::memcpy(&x, m.data._buffer, sizeof x);
    EXPECT_EQ(x, 1.5f);
    return true;
  }));
  ASSERT_TRUE(take_until<CloudMessage>(other, [](const CloudMessage& m) {
    EXPECT_STREQ(m.header.frame_id, "bert/map");
    return m.width == 1;
  }));
}

TEST_F(BridgeRig, AlignmentsAreToldWithTheirConfidenceUntilWithdrawn) {
  ASSERT_TRUE(start(1));
  robot().say(hello_line("anna"));
  robot().say(alignment_line("bert", 0, "candidate", {10, -1, 1.0}));
  const auto alignment =
      listener_->subscribe("rt/peers/bert/alignment", kPoseWithCovarianceStamped);
  const auto confidence = listener_->subscribe("rt/peers/bert/confidence", kFloat);
  const auto fixed = listener_->subscribe("rt/tf_static", kTransforms, {100, true});
  ASSERT_TRUE(listener_->matched(fixed));
  ASSERT_TRUE(hears({alignment, confidence}, 0,
                    alignment_line("bert", 0, "candidate", {10, -1, 1.0}, kProbe_ns)));
  robot().say(alignment_line("bert", 0, "merged", {10, -1, 1.0}));
  ASSERT_TRUE(take_until<PoseMessage>(alignment, [](const PoseMessage& m) {
    if (is_probe(m.header)) return false;
    EXPECT_STREQ(m.header.frame_id, "map");
    const auto& p = m.pose.pose.position;
    expect_pose(pose_of(m.pose.pose.orientation, p.x, p.y), {10, -1, 1.0});
    EXPECT_EQ(m.pose.covariance[0], 0.25);
    EXPECT_EQ(m.pose.covariance[7], 0.5);
    EXPECT_EQ(m.pose.covariance[35], 0.125);
    return true;
  }));
  ASSERT_TRUE(take_until<std_msgs_msg_dds__Float32_>(
      confidence, [](const std_msgs_msg_dds__Float32_& m) { return m.data == 0.75f; }));
  robot().say(radio_line());
  ASSERT_TRUE(take_until<TransformsMessage>(
      fixed, [](const TransformsMessage& m) { return m.transforms._length == 1; }));
  robot().say(alignment_line("bert", 0, "withdrawn", {10, -1, 1.0}));
  robot().say(radio_line());
  ASSERT_TRUE(take_until<TransformsMessage>(
      fixed, [](const TransformsMessage& m) { return m.transforms._length == 0; }));
}

// The level and message of the status with this name.
std::pair<int, std::string> status_of(const DiagnosticsMessage& m, const std::string& name) {
  for (std::uint32_t i = 0; i < m.status._length; ++i) {
    const auto& s = m.status._buffer[i];
    if (name == s.name) return {s.level, s.message};
  }
  return {-1, ""};
}

TEST_F(BridgeRig, ARobotThatLeavesIsStaleAndGoesOnWhenItIsBack) {
  ASSERT_TRUE(start(1));
  robot().say(hello_line("anna"));
  const auto odom = listener_->subscribe("rt/odom", kOdometry);
  const auto health = listener_->subscribe("rt/diagnostics", kDiagnostics);
  ASSERT_TRUE(listener_->matched(health));
  ASSERT_TRUE(hears_motion({odom}));
  const auto becomes = [&](int level, const std::string& message) {
    return take_until<DiagnosticsMessage>(health, [&](const DiagnosticsMessage& m) {
      return status_of(m, "zenith: anna") == std::make_pair(level, message);
    });
  };
  robot().say(health_line("degraded", "a step takes too long"));
  EXPECT_TRUE(becomes(1, "degraded: a step takes too long"));
  robot().say(health_line("mapping"));
  EXPECT_TRUE(becomes(0, "mapping"));
  robot().leave();
  ASSERT_TRUE(take_until<DiagnosticsMessage>(health, [&](const DiagnosticsMessage& m) {
    return status_of(m, "zenith: anna").first == 3;
  }));
  // The daemon began anew: its frames, too.
  ASSERT_TRUE(robot().wait_for_reader(kPatience_s));
  robot().say(hello_line("anna", 2));
  robot().say(pose_line(9'000'000'000, {0.1, 0, 0}, {0.2, 0, 0}));
  ASSERT_TRUE(take_until<OdometryMessage>(
      odom, [](const OdometryMessage& m) { return m.pose.pose.position.x == 0.2; }));
  robot().say(health_line("mapping"));
  EXPECT_TRUE(becomes(0, "mapping"));
}

// bert has found anna's map and dora's, anna nobody: one tree below anna's map.
TEST_F(BridgeRig, SeveralRobotsHaveTheirNamesAndOneTreeOfMaps) {
  ASSERT_TRUE(start(2));
  robot(0).say(hello_line("anna"));
  robot(1).say(hello_line("bert_2"));
  const auto odom = listener_->subscribe("rt/bert_2/odom", kOdometry);
  const auto tf = listener_->subscribe("rt/tf", kTransforms, {100});
  const auto fixed = listener_->subscribe("rt/tf_static", kTransforms, {100, true});
  ASSERT_TRUE(listener_->matched(fixed));
  ASSERT_TRUE(hears_motion({odom, tf}, 1));
  ASSERT_TRUE(take_until<OdometryMessage>(odom, [](const OdometryMessage& m) {
    EXPECT_STREQ(m.header.frame_id, "bert_2/odom");
    EXPECT_STREQ(m.child_frame_id, "bert_2/base_link");
    return true;
  }));
  ASSERT_TRUE(take_until<TransformsMessage>(tf, [](const TransformsMessage& m) {
    return by_name(m).count("bert_2/map>bert_2/odom") == 1;
  }));
  const Pose2 T_bert_anna = {10, -1, 1.0};
  const Pose2 T_bert_dora = {2, 3, -0.5};
  robot(1).say(alignment_line("anna", 0, "merged", T_bert_anna));
  robot(1).say(alignment_line("dora", 1, "merged", T_bert_dora));
  robot(1).say(radio_line());
  ASSERT_TRUE(take_until<TransformsMessage>(fixed, [&](const TransformsMessage& m) {
    const auto told = by_name(m);
    if (told.size() != 2) return false;
    expect_pose(told.at("anna/map>bert_2/map"), T_bert_anna.inverse());
    expect_pose(told.at("anna/map>dora/map"), T_bert_anna.inverse() * T_bert_dora);
    return true;
  }));
}

TEST_F(BridgeRig, TransformsAreLeftToOthersWhereAsked) {
  ASSERT_TRUE(start(1, {"--no-tf", "--no-peers-tf", "--names", "always", "--map-frame", "earth"}));
  robot().say(hello_line("anna"));
  const auto pose = listener_->subscribe("rt/anna/pose", kPoseWithCovarianceStamped);
  const auto tf = listener_->subscribe("rt/tf", kTransforms, {100});
  const auto fixed = listener_->subscribe("rt/tf_static", kTransforms, {100, true});
  ASSERT_TRUE(listener_->matched(tf) && listener_->matched(fixed));
  ASSERT_TRUE(hears_motion({pose}));
  robot().say(alignment_line("bert", 0, "merged", {}));
  robot().say(radio_line());
  robot().say(pose_line(1'000'000'000, {}, {}));
  ASSERT_TRUE(take_until<PoseMessage>(pose, [](const PoseMessage& m) {
    EXPECT_STREQ(m.header.frame_id, "anna/earth");
    return !is_probe(m.header);
  }));
  const auto any = [](const TransformsMessage&) { return true; };
  EXPECT_FALSE(take_until<TransformsMessage>(tf, any, 0.5));
  EXPECT_FALSE(take_until<TransformsMessage>(fixed, any, 0.0));
}

TEST_F(BridgeRig, EndsWhenItIsAskedTo) {
  ASSERT_TRUE(start(1));
  bridge_->send(SIGTERM);
  EXPECT_EQ(bridge_->wait(kPatience_s), 0);
}

}  // namespace
}  // namespace zenith
