// From telemetry and the plane into ROS 2's messages.

#include "tools/ros2/convert.h"

#include <cmath>
#include <cstring>
#include <numbers>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/tools/told_line.h"
#include "tools/ros2/landmark_cloud.h"
#include "tools/ros2/names.h"

namespace zenith::ros2 {
namespace {

using nlohmann::json;
using tools::told;

TEST(Ros2Convert, AYawIsAQuaternionAboutZ) {
  for (const double yaw : {-3.1, -0.5, 0.0, 0.7, 3.0}) {
    const auto q = to_quaternion(yaw);
    EXPECT_EQ(q.x, 0.0);
    EXPECT_EQ(q.y, 0.0);
    EXPECT_NEAR(std::atan2(2 * q.w * q.z, 1 - 2 * q.z * q.z), yaw, 1e-12);
    EXPECT_NEAR(q.z * q.z + q.w * q.w, 1.0, 1e-15);
  }
}

TEST(Ros2Convert, CovariancesStandRowByRowAtXYAndYaw) {
  double out[36];
  std::fill(std::begin(out), std::end(out), 7.0);
  put_covariance({1, 2, 3, 4, 5, 6}, out);
  const double expected[6][6] = {{1, 2, 0, 0, 0, 3}, {2, 4, 0, 0, 0, 5}, {0, 0, 0, 0, 0, 0},
                                 {0, 0, 0, 0, 0, 0}, {0, 0, 0, 0, 0, 0}, {3, 5, 0, 0, 0, 6}};
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      EXPECT_EQ(out[6 * row + column], expected[row][column]) << row << ' ' << column;
    }
  }
}

TEST(Ros2Convert, TimesAreSecondsAndNanoseconds) {
  const auto time = to_time(1'767'225'600'123'456'789);
  EXPECT_EQ(time.sec, 1'767'225'600);
  EXPECT_EQ(time.nanosec, 123'456'789u);
}

json pose_line() {
  return {{"type", "pose"},
          {"stamp_ns", 5'000'000'007},
          {"pose", {1.0, 2.0, 0.5}},
          {"covariance", {1, 2, 3, 4, 5, 6}},
          {"odometry",
           {{"pose", {4.0, -1.0, -0.25}},
            {"covariance", {6, 5, 4, 3, 2, 1}},
            {"velocity", {0.5, 0.0, 0.125}},
            {"velocity_covariance", {1, 0, 0, 1, 0, 1}}}}};
}

TEST(Ros2Motion, MapToOdomToBaseIsTheRobotInTheMap) {
  const auto motion = read_motion(told(pose_line()), 1'000'000'000'000'000'000);
  ASSERT_TRUE(motion);
  EXPECT_EQ(motion->system_ns, 1'000'000'005'000'000'007);
  const Pose2 chained = motion->T_map_odom() * motion->T_odom_base;
  EXPECT_NEAR(chained.x_m, 1.0, 1e-12);
  EXPECT_NEAR(chained.y_m, 2.0, 1e-12);
  EXPECT_NEAR(chained.theta_rad, 0.5, 1e-12);
  EXPECT_EQ(motion->velocity[2], 0.125);
  EXPECT_EQ(motion->odom_covariance[5], 1.0);
}

bool is_motion(const json& line) {
  const auto decoded = tools::decode_telemetry(line.dump());
  return decoded.line && read_motion(*decoded.line, 1);
}

TEST(Ros2Motion, IsNothingWithoutAllNumbers) {
  for (const char* key : {"stamp_ns", "pose", "covariance", "odometry"}) {
    json line = pose_line();
    line.erase(key);
    EXPECT_FALSE(is_motion(line)) << key;
  }
  for (const char* key : {"pose", "covariance", "velocity", "velocity_covariance"}) {
    json line = pose_line();
    line["odometry"][key][0] = nullptr;  // what telemetry makes of "not a number"
    EXPECT_FALSE(is_motion(line)) << key;
  }
  EXPECT_FALSE(is_motion(json::array()));
  EXPECT_TRUE(is_motion(pose_line()));
  json late = pose_line();
  late["stamp_ns"] = 4'000'000'000'000'000'000;
  EXPECT_FALSE(is_motion(late)) << "ROS 2's seconds end in 2038";
}

TEST(Ros2Names, AreThoseThatRos2Allows) {
  EXPECT_EQ(ros_name("anna"), "anna");
  EXPECT_EQ(ros_name("anna_2"), "anna_2");
  EXPECT_EQ(ros_name("past self"), "past_self");
  EXPECT_EQ(ros_name("anna past self"), "anna_past_self");
  for (const char* name : {"robot-7 (old)", "a__b", "7up", "", "\u00e4", "/", "a b"}) {
    const std::string made = ros_name(name);
    EXPECT_THAT(made, testing::MatchesRegex("[A-Za-z_][A-Za-z0-9_]*_[0-9a-f]{8}")) << name;
    EXPECT_THAT(made, testing::Not(testing::HasSubstr("__")));
    EXPECT_EQ(made, ros_name(name)) << "the same each time";
  }
  EXPECT_EQ(ros_name("robot-7"), "robot_7_3279df1e");
}

TEST(Ros2Names, NamesThatDifferStayApart) {
  const std::string hashed = ros_name("a-1");
  std::set<std::string> made;
  const std::vector<std::string> names = {"a_1",
                                          "a-1",
                                          "a 1",
                                          "a.1",
                                          "a/1",
                                          "a__1",
                                          "\u00e4",
                                          "\u00f6",
                                          "\u4e00",
                                          "\u4e8c",
                                          "1",
                                          "r1",
                                          "past self",
                                          "past_self",
                                          "_",
                                          "",
                                          "anna past self",
                                          "anna_past_self",
                                          hashed,
                                          "a-1 past self",
                                          "A_1"};
  for (const std::string& name : names) {
    EXPECT_TRUE(made.insert(ros_name(name)).second) << name << " shares " << ros_name(name);
  }
}

TEST(Ros2Names, HaveThePrefixesOfRos2AndOfTheRobot) {
  const RobotNames alone("anna", {}, false);
  EXPECT_EQ(alone.topic("odom"), "rt/odom");
  EXPECT_EQ(alone.map(), "map");
  EXPECT_EQ(alone.map_of("bert"), "bert/map");
  const std::string anna = ros_name("anna-1");
  const RobotNames one("anna-1", {"earth", "wheels", "base_footprint"}, true);
  EXPECT_EQ(one.topic("odom"), "rt/" + anna + "/odom");
  EXPECT_EQ(one.map(), anna + "/earth");
  EXPECT_EQ(one.odom(), anna + "/wheels");
  EXPECT_EQ(one.base(), anna + "/base_footprint");
  EXPECT_EQ(one.map_of("anna-1"), one.map());
}

template <typename T>
T word(const sensor_msgs_msg_dds__PointCloud2_& cloud, std::size_t point, const char* field) {
  T value = {};
  for (std::uint32_t i = 0; i < cloud.fields._length; ++i) {
    const auto& f = cloud.fields._buffer[i];
    if (std::strcmp(f.name, field) != 0) continue;
    EXPECT_EQ(f.count, 1u);
    EXPECT_EQ(f.datatype, (std::is_same_v<T, float> ? 7 : 6));
    std::memcpy(&value, cloud.data._buffer + point * cloud.point_step + f.offset, sizeof value);
  }
  return value;
}

TEST(Ros2Cloud, HasALandmarkInEachPoint) {
  // The second one's ellipse is turned by 45 degrees: 5 cm and 1 cm.
  const std::vector<tools::RobotState::Row> rows = {
      {4'000'000'001.0, 1.5, -2.5, 3.25, 4e-4, 0.0, 9e-4, 1e-2, 12},
      {2.0, 0.0, 0.0, 0.0, 13e-4, 12e-4, 13e-4, 0.0, 3}};
  const LandmarkCloud cloud(1, "map", rows);
  const auto& m = cloud.message();
  EXPECT_STREQ(m.header.frame_id, "map");
  EXPECT_EQ(m.height, 1u);
  ASSERT_EQ(m.width, 2u);
  EXPECT_EQ(m.data._length, m.row_step);
  EXPECT_EQ(m.row_step, m.width * m.point_step);
  EXPECT_TRUE(m.is_dense);
  EXPECT_EQ(word<float>(m, 0, "x"), 1.5f);
  EXPECT_EQ(word<float>(m, 0, "y"), -2.5f);
  EXPECT_EQ(word<float>(m, 0, "z"), 3.25f);
  EXPECT_EQ(word<std::uint32_t>(m, 0, "id"), 4'000'000'001u);
  EXPECT_EQ(word<std::uint32_t>(m, 1, "observations"), 3u);
  EXPECT_NEAR(word<float>(m, 0, "sigma_xy"), 0.03f, 1e-6f);
  EXPECT_NEAR(word<float>(m, 1, "sigma_xy"), 0.05f, 1e-6f);
  EXPECT_NEAR(word<float>(m, 0, "sigma_z"), 0.1f, 1e-6f);
  const LandmarkCloud empty(1, "map", {});
  EXPECT_EQ(empty.message().width, 0u);
  EXPECT_EQ(empty.message().fields._length, 7u);
}

}  // namespace
}  // namespace zenith::ros2
