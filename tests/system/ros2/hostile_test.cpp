// A robot that tells nonsense to zenith-ros2, and names that are made to collide or to run out.

#include <gmock/gmock.h>

#include "tests/system/ros2/bridge_rig.h"
#include "tools/ros2/names.h"
#include "tools/ros2/robot_topics.h"

namespace zenith {
namespace {

using testing::HasSubstr;

class HostileBridge : public BridgeRig {};

TEST_F(HostileBridge, NonsenseIsSkippedAndTheRestGoesOn) {
  ASSERT_TRUE(start(1));
  for (const char* line :
       {"", "x", R"({"type":5})", R"({"type":"hello","robot":7})", R"({"type":"hello"})",
        R"({"type":"hello","robot":"a\u001b[2J"})", R"({"type":"pose","pose":"here"})",
        R"({"type":"pose","pose":[0,0,0],"stamp_ns":{}})", R"({"type":"alignment","name":7})",
        R"({"type":"alignment","name":"b","state":{},"pose":"x","confidence":"y"})",
        R"({"type":"peer","name":"b","peer":{}})", R"({"type":"radio","peers":[]})",
        R"({"type":"health","state":[]})", R"({"type":"hello","robot":"a","system_offset_ns":"x"})",
        R"({"type":"landmarks","peer":-1,"rows":["x"],"gone":{}})"}) {
    robot().say_text(line);
  }
  robot().say(hello_line("anna"));
  for (const char* line : {R"({"type":"alignment","name":"b","state":7})",
                           R"({"type":"pose","pose":[1,2],"stamp_ns":1e300})"}) {
    robot().say_text(line);
  }
  const auto odom = listener_->subscribe("rt/odom", ros2::kOdometry);
  ASSERT_TRUE(hears_motion({odom}));
  bridge_->send(SIGTERM);
  EXPECT_EQ(bridge_->wait(kPatience_s), 0);
  EXPECT_THAT(tools::read_text(log("log")), HasSubstr("a line of its telemetry was skipped"));
}

TEST_F(HostileBridge, NamesThatAreNearlyTheSameHaveTopicsOfTheirOwn) {
  ASSERT_TRUE(start(1));
  robot().say(hello_line("anna"));
  const auto confidence = [](const std::string& name) {
    return "rt/peers/" + ros2::ros_name(name) + "/confidence";
  };
  const auto plain = listener_->subscribe(confidence("a_1"), ros2::kFloat);
  const auto dashed = listener_->subscribe(confidence("a-1"), ros2::kFloat);
  const auto spaced = listener_->subscribe(confidence("a 1"), ros2::kFloat);
  const auto say = [&](const std::string& name, double value) {
    auto line = alignment_line(name, 0, "candidate", {});
    line["confidence"] = value;
    robot().say(line);
  };
  ASSERT_TRUE(wait_until(kPatience_s, [&] {
    say("a_1", 0.25);
    say("a-1", 0.5);
    say("a 1", 0.75);
    const auto hears = [](dds_entity_t reader) {
      dds_subscription_matched_status_t status = {};
      return dds_get_subscription_matched_status(reader, &status) == DDS_RETCODE_OK &&
             status.current_count == 1;
    };
    return hears(plain) && hears(dashed) && hears(spaced);
  }));
  for (const auto& [reader, value] :
       {std::pair{plain, 0.25f}, std::pair{dashed, 0.5f}, std::pair{spaced, 0.75f}}) {
    for (int i = 0; i < 3; ++i) {
      float found = 0.0F;
      ASSERT_TRUE(wait_until(kPatience_s, [&] {
        say("a_1", 0.25);
        say("a-1", 0.5);
        say("a 1", 0.75);
        return take_until<std_msgs_msg_dds__Float32_>(
            reader,
            [&](const std_msgs_msg_dds__Float32_& m) {
              found = m.data;
              return true;
            },
            0.1);
      }));
      EXPECT_EQ(found, value);
    }
  }
}

// More names than there is room for, while all others fall silent.
TEST_F(HostileBridge, EverNewNamesTakeTheTopicsOfTheSilent) {
  ASSERT_TRUE(start(1));
  robot().say(hello_line("anna"));
  for (std::size_t i = 0; i < ros2::RobotTopics::kPeers; ++i) {
    robot().say(alignment_line("old" + std::to_string(i), 0, "candidate", {}));
  }
  const auto late = listener_->subscribe("rt/peers/late/confidence", ros2::kFloat);
  EXPECT_TRUE(wait_until(kPatience_s, [&] {
    robot().say(alignment_line("late", 0, "candidate", {}));
    return take_until<std_msgs_msg_dds__Float32_>(
        late, [](const std_msgs_msg_dds__Float32_&) { return true; }, 0.2);
  }));
  bridge_->send(SIGTERM);
  EXPECT_EQ(bridge_->wait(kPatience_s), 0);
  EXPECT_THAT(tools::read_text(log("log")), HasSubstr("end: it is silent, and late is heard"));
}

TEST_F(HostileBridge, TwoRobotsOfOneNameDoNotShareTopics) {
  ASSERT_TRUE(start(2));
  robot(0).say(hello_line("anna"));
  const auto odom = listener_->subscribe("rt/anna/odom", ros2::kOdometry);
  ASSERT_TRUE(hears_motion({odom}));
  robot(1).say(hello_line("anna"));
  robot(1).say(pose_line(7'000'000'000, {}, {99, 0, 0}));
  robot(0).say(pose_line(8'000'000'000, {}, {1, 0, 0}));
  ASSERT_TRUE(take_until<OdometryMessage>(odom, [](const OdometryMessage& m) {
    EXPECT_NE(m.pose.pose.position.x, 99.0);
    return m.pose.pose.position.x == 1.0;
  }));
  EXPECT_TRUE(wait_until(kPatience_s, [&] {
    return tools::read_text(log("log")).find("two robots say that they are anna") !=
           std::string::npos;
  }));
}

}  // namespace
}  // namespace zenith
