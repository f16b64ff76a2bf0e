// Any bytes as the telemetry of two robots, a line each: what decodes goes into the state that the
// page, Prometheus, Foxglove's viewers and ROS 2 are told from. Nothing of it grows beyond its
// bounds, everything that is made of it is valid, and no exception leaves anything.

#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "platform/base/printable.h"
#include "tests/fuzz/require.h"
#include "tools/ros2/motion.h"
#include "tools/ros2/names.h"
#include "tools/view/bounded_json.h"
#include "tools/view/foxglove_session.h"
#include "tools/view/history.h"
#include "tools/view/look_back.h"
#include "tools/view/metrics.h"
#include "tools/view/placement.h"

using namespace zenith;         // NOLINT(google-build-using-namespace)
using namespace zenith::tools;  // NOLINT(google-build-using-namespace)

namespace {

using nlohmann::json;

constexpr std::size_t kRobots = 2;

void check_line(const TelemetryLine& line) {
  require(!line.type().empty());
  require(line.stamp_ns() >= 0);
  // Strictly: throws where a text is no UTF-8.
  require(!line.shown().dump().empty());
  const std::int64_t stamp = ros2::system_stamp(line, line.system_offset_ns().value_or(0));
  require(stamp >= 0 && stamp / 1'000'000'000 <= INT32_MAX);
  if (const auto motion = ros2::read_motion(line, line.system_offset_ns().value_or(0))) {
    for (const double v : motion->odom_covariance) require(std::isfinite(static_cast<float>(v)));
  }
  if (const auto* marks = line.as<LandmarksLine>()) {
    require(marks->owner >= kOwnMap && marks->owner < kMostSlots);
    for (const LandmarkRow& row : marks->rows) {
      for (const double v : row) require(std::isfinite(static_cast<float>(v)));
    }
  }
  if (const auto* peer = line.as<AlignmentLine>()) {
    require(peer->name.size() <= kLongestName && is_printable(peer->name));
    const std::string name = ros2::ros_name(peer->name);
    require(!name.empty() && name.find("__") == std::string::npos);
    require(
        name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") ==
        std::string::npos);
  }
}

// As JSON: with one key at least, and nothing that dump() would throw at.
void check_told(const json& answer) {
  require(answer.at("robots").size() == kRobots);
  require(!answer.dump().empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FleetState state;
  History history(20'000);
  for (std::size_t i = 0; i < kRobots; ++i) {
    state.add("robot");
    history.add("robot");
  }
  LookBack look_back(state, history);
  FoxgloveSession viewer;
  viewer.receive(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1},)"
                 R"({"id":2,"channelId":10},{"id":3,"channelId":11},{"id":4,"channelId":20}]})");
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  std::int64_t seconds = 0;
  json seen = look_back.answer(json::object());
  while (!rest.empty()) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    const std::size_t robot = static_cast<std::size_t>(++seconds) % kRobots;
    const DecodedLine decoded = decode_telemetry(line);
    if (!decoded.line) {
      state.count_refused(robot, decoded.fault);
      continue;
    }
    check_line(*decoded.line);
    state.apply(robot, *decoded.line);
    state.read([&](const std::vector<RobotState>& robots) {
      history.note(robot, robots[robot], *decoded.line, line, Time{seconds * 1'000'000'000});
      for (const FoxgloveMessage& message : viewer.turn(seconds * 1'000'000'000, robots)) {
        require(message.binary || json::accept(message.bytes));
      }
      require(robots[robot].lines().size() <= 2 * RobotState::kMostPeers + 8);
      (void)place_starts(robots, robot);
    });
    seen = look_back.answer({{"epoch", seen["epoch"]}, {"seen", seen["seen"]}});
    check_told(seen);
  }
  check_told(look_back.answer(json::object()));
  check_told(look_back.answer({{"past", true}, {"control", {{"look_back", 0.5}}}}));
  const std::string metrics = metrics_text(state);
  require(metrics.find("zenith_up") != std::string::npos);
  return 0;
}
