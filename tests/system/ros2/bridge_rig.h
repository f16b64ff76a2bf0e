#pragma once
// zenith-ros2 under test, beside robots that the test plays, and somebody who listens.

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include <zenith_ros2_idl/diagnostic_msgs.h>
#include <zenith_ros2_idl/nav_msgs.h>
#include <zenith_ros2_idl/sensor_msgs.h>
#include <zenith_ros2_idl/tf2_msgs.h>
#include <nlohmann/json.hpp>

#include "slam/geometry.h"
#include "tests/system/ros2/listener.h"
#include "tests/system/ros2/told_daemon.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {

using OdometryMessage = nav_msgs_msg_dds__Odometry_;
using PoseMessage = geometry_msgs_msg_dds__PoseWithCovarianceStamped_;
using TransformsMessage = tf2_msgs_msg_dds__TFMessage_;
using CloudMessage = sensor_msgs_msg_dds__PointCloud2_;
using DiagnosticsMessage = diagnostic_msgs_msg_dds__DiagnosticArray_;

inline constexpr std::int64_t kOffset_ns = 1'767'225'600'000'000'000;  // a day in 2026

// Telemetry's lines.
inline nlohmann::json hello_line(const std::string& robot, std::int64_t started_ns = 1) {
  return {{"type", "hello"},
          {"robot", robot},
          {"started_ns", started_ns},
          {"system_offset_ns", kOffset_ns}};
}
inline nlohmann::json pose_line(std::int64_t stamp_ns, const Pose2& map, const Pose2& odom) {
  return {{"type", "pose"},
          {"stamp_ns", stamp_ns},
          {"pose", {map.x_m, map.y_m, map.theta_rad}},
          {"covariance", {0.01, 0.02, 0.03, 0.04, 0.05, 0.06}},
          {"odometry",
           {{"pose", {odom.x_m, odom.y_m, odom.theta_rad}},
            {"covariance", {0.1, 0.2, 0.3, 0.4, 0.5, 0.6}},
            {"velocity", {0.5, 0.0, -0.25}},
            {"velocity_covariance", {1.0, 0.0, 0.0, 2.0, 0.0, 3.0}}}}};
}
inline nlohmann::json alignment_line(const std::string& peer, int slot, const std::string& state,
                                     const Pose2& pose, std::int64_t stamp_ns = 3'000'000'000) {
  return {{"type", "alignment"},
          {"stamp_ns", stamp_ns},
          {"peer", slot},
          {"name", peer},
          {"state", state},
          {"pose", {pose.x_m, pose.y_m, pose.theta_rad}},
          {"variance", {0.25, 0.5, 0.125}},
          {"confidence", 0.75},
          {"correspondences", 40}};
}
inline nlohmann::json landmarks_line(int owner, std::vector<double> rows) {
  return {{"type", "landmarks"},
          {"peer", owner},
          {"name", ""},
          {"rows", std::move(rows)},
          {"gone", nlohmann::json::array()}};
}
inline nlohmann::json health_line(const std::string& state, const std::string& reason = "") {
  return {{"type", "health"}, {"state", state}, {"reason", reason}};
}
// The last of a second's lines that the bridge waits for.
inline nlohmann::json radio_line() {
  return {{"type", "radio"}, {"peers", 1}};
}

inline Pose2 pose_of(const geometry_msgs_msg_dds__Quaternion_& q, double x, double y) {
  return {x, y, 2.0 * std::atan2(q.z, q.w)};
}
inline std::int64_t ns_of(const std_msgs_msg_dds__Header_& header) {
  return header.stamp.sec * std::int64_t{1'000'000'000} + header.stamp.nanosec;
}

// A message that was told to find out whether it arrives.
inline constexpr std::int64_t kProbe_ns = 1;
inline bool is_probe(const std_msgs_msg_dds__Header_& header) {
  return ns_of(header) == kOffset_ns + kProbe_ns;
}

class BridgeRig : public ::testing::Test {
 protected:
  void SetUp() override {
    use_loopback_domain();
    listener_ = std::make_unique<Listener>();
  }
  // The bridge with so many robots, which it hears.
  bool start(std::size_t robots, std::vector<std::string> options = {}) {
    for (std::size_t i = 0; i < robots; ++i) {
      daemons_.push_back(
          std::make_unique<ToldDaemon>((folder_.path() / ("robot" + std::to_string(i))).string()));
    }
    return start_bridge(std::move(options), [&] {
      bool all = true;
      for (auto& daemon : daemons_) all = daemon->wait_for_reader(kPatience_s) && all;
      return all;
    });
  }
  template <typename Ready>
  bool start_bridge(std::vector<std::string> options, Ready ready) {
    std::vector<std::string> words = {ZENITH_ROS2, "--domain", std::to_string(kTestDomain)};
    words.insert(words.end(), options.begin(), options.end());
    for (const auto& daemon : daemons_) words.push_back(daemon->path());
    bridge_ = std::make_unique<Process>(words, log("out"), log("log"));
    return ready();
  }
  std::string log(const std::string& which) const {
    return (folder_.path() / ("bridge." + which)).string();
  }
  void TearDown() override {
    if (HasFailure()) printf("%s", tools::read_text(log("log")).c_str());
  }
  // Whether what the robot says from now on arrives at all of these readers: `line` is a probe,
  // said until each has heard something.
  bool hears(const std::vector<dds_entity_t>& readers, std::size_t number,
             const nlohmann::json& line) {
    return wait_until(kPatience_s, [&] {
      robot(number).say(line);
      sleep_until(monotonic_now() + Duration{50'000'000});
      for (const dds_entity_t reader : readers) {
        void* sample = nullptr;
        dds_sample_info_t info = {};
        const dds_return_t count = dds_read(reader, &sample, &info, 1, 1);
        if (count > 0) dds_return_loan(reader, &sample, count);
        if (count != 1) return false;
      }
      return true;
    });
  }
  bool hears_motion(const std::vector<dds_entity_t>& readers, std::size_t number = 0) {
    return hears(readers, number, pose_line(kProbe_ns, {}, {}));
  }
  ToldDaemon& robot(std::size_t i = 0) { return *daemons_[i]; }

  tools::TemporaryFolder folder_;
  std::unique_ptr<Listener> listener_;
  std::vector<std::unique_ptr<ToldDaemon>> daemons_;
  std::unique_ptr<Process> bridge_;
};

}  // namespace zenith
