#include "tools/view/foxglove_session.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "platform/base/base64.h"
#include "tools/report/colour.h"
#include "tools/view/bounded_json.h"
#include "tools/view/placement.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

constexpr std::uint32_t kFrames = 1;
constexpr std::uint32_t kPerRobot = 10;
constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr JsonLimits kMessageLimits = {WebSocketReader::kMostBytes, 5, 4096};
constexpr std::int64_t kLastChannel = (kMostRobots + 1) * kPerRobot;

std::uint32_t scene_of(std::size_t robot) {
  return static_cast<std::uint32_t>(robot + 1) * kPerRobot;
}
std::uint32_t image_of(std::size_t robot) {
  return scene_of(robot) + 1;
}

json stamp(std::int64_t ns) {
  return {{"sec", ns / kSecond_ns}, {"nsec", ns % kSecond_ns}};
}

json turned(double yaw_rad) {
  return {{"x", 0}, {"y", 0}, {"z", std::sin(yaw_rad / 2)}, {"w", std::cos(yaw_rad / 2)}};
}

json point(double x, double y, double z) {
  return {{"x", x}, {"y", y}, {"z", z}};
}

json frame(std::int64_t ns, const std::string& parent, const std::string& child, const Pose2& T) {
  return {{"timestamp", stamp(ns)},
          {"parent_frame_id", parent},
          {"child_frame_id", child},
          {"translation", point(T.x_m, T.y_m, 0)},
          {"rotation", turned(T.theta_rad)}};
}

json colour_of(std::size_t robot, double alpha) {
  const Colour c = robot_colour(robot);
  return {{"r", c.red / 255.0}, {"g", c.green / 255.0}, {"b", c.blue / 255.0}, {"a", alpha}};
}

json channel(std::uint32_t id, const std::string& topic, const std::string& schema) {
  return {{"id", id},
          {"topic", topic},
          {"encoding", "json"},
          {"schemaName", schema},
          {"schemaEncoding", "jsonschema"},
          {"schema", foxglove_schema(schema)}};
}

// Two sigma each way, large enough to be seen.
double size_of(double variance) {
  return std::max(0.05, 4.0 * std::sqrt(std::max(variance, 0.0)));
}

json spheres_of(const std::vector<RobotState::Row>& landmarks, std::size_t colour) {
  json spheres = json::array();
  for (const auto& [id, x, y, z, xx, xy, yy, zz, observations] : landmarks) {
    spheres.push_back({{"pose", {{"position", point(x, y, z)}, {"orientation", turned(0)}}},
                       {"size", point(size_of(xx), size_of(yy), size_of(zz))},
                       {"color", colour_of(colour, 0.7)}});
  }
  return spheres;
}

json line_of(const Series<3>& path, std::size_t colour) {
  json points = json::array();
  for (std::size_t i = 0; i < path.size(); ++i) points.push_back(point(path[i][0], path[i][1], 0));
  return {{"type", 0},
          {"pose", {{"position", point(0, 0, 0)}, {"orientation", turned(0)}}},
          {"thickness", 3},
          {"scale_invariant", true},
          {"points", points},
          {"color", colour_of(colour, 1.0)},
          {"colors", json::array()},
          {"indices", json::array()}};
}

json entity(std::int64_t ns, const std::string& name, const std::string& what) {
  json made = {{"timestamp", stamp(ns)},
               {"frame_id", name + "/start"},
               {"id", name + "/" + what},
               {"lifetime", stamp(0)},
               {"frame_locked", true}};
  for (const char* kind : {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines",
                           "triangles", "texts", "models"}) {
    made[kind] = json::array();
  }
  return made;
}

FoxgloveMessage text_message(const json& message) {
  return {false, message.dump(-1, ' ', false, json::error_handler_t::replace)};
}

}  // namespace

FoxgloveMessage FoxgloveSession::server_info() {
  return text_message({{"op", "serverInfo"},
                       {"name", "zenith view"},
                       {"capabilities", json::array()},
                       {"supportedEncodings", {"json"}}});
}

void FoxgloveSession::receive(std::string_view text) {
  const json said = parse_bounded(text, kMessageLimits).value;
  const auto op = read_text(member(said, "op"), kLongestName);
  if (op == "subscribe") {
    for (const json& wish : member(said, "subscriptions")) {
      const auto id = read_integer(member(wish, "id"), 0, UINT32_MAX);
      const auto wanted = read_integer(member(wish, "channelId"), 0, kLastChannel);
      if (!id || !wanted) continue;
      const auto to = static_cast<Channel>(*wanted);
      pictures_.erase(to / kPerRobot - 1);  // the last one is sent once more
      subscriptions_[to] = static_cast<std::uint32_t>(*id);
    }
  } else if (op == "unsubscribe") {
    for (const json& gone : member(said, "subscriptionIds")) {
      const auto id = read_integer(gone, 0, UINT32_MAX);
      if (!id) continue;
      std::erase_if(subscriptions_, [&](const auto& entry) { return entry.second == *id; });
    }
  }
}

// Once a second, also when it is subscribed again and again.
bool FoxgloveSession::is_due(Channel channel, std::int64_t now_ns) {
  if (!subscribed(channel)) return false;
  std::int64_t& next = next_ns_[channel];
  if (now_ns < next && next - now_ns <= kSecond_ns) return false;
  next = now_ns + kSecond_ns;
  return true;
}

bool FoxgloveSession::wants_picture(std::size_t robot) const {
  return subscribed(image_of(robot));
}

// Robots are told of when their names are known, and once more when a name changes.
std::optional<FoxgloveMessage> FoxgloveSession::advertise(const std::vector<RobotState>& robots) {
  json channels = json::array();
  if (advertised_.empty()) channels.push_back(channel(kFrames, "/tf", "foxglove.FrameTransform"));
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (robots[i].line("hello").empty() || advertised_.count(i) > 0) continue;
    const std::string& name = robots[i].name();
    advertised_[i] = name;
    channels.push_back(channel(scene_of(i), "/" + name + "/scene", "foxglove.SceneUpdate"));
    channels.push_back(channel(image_of(i), "/" + name + "/image", "foxglove.CompressedImage"));
  }
  if (channels.empty() || advertised_.empty()) return std::nullopt;
  return text_message({{"op", "advertise"}, {"channels", channels}});
}

void FoxgloveSession::put(std::vector<FoxgloveMessage>& out, Channel to, std::int64_t stamp_ns,
                          const json& message) const {
  const auto found = subscriptions_.find(to);
  if (found == subscriptions_.end()) return;
  const std::string payload = message.dump(-1, ' ', false, json::error_handler_t::replace);
  FoxgloveMessage data{true, std::string(1, '\x01')};
  for (unsigned i = 0; i < 4; ++i) {
    data.bytes += static_cast<char>(found->second >> (8 * i) & 0xffU);
  }
  const auto time = static_cast<std::uint64_t>(stamp_ns);
  for (unsigned i = 0; i < 8; ++i) data.bytes += static_cast<char>(time >> (8 * i) & 0xffU);
  data.bytes += payload;
  out.push_back(std::move(data));
}

void FoxgloveSession::put_frames(std::vector<FoxgloveMessage>& out,
                                 const std::vector<RobotState>& robots, std::int64_t now_ns) {
  for (const auto& [name, T_map_start] : place_starts(robots)) {
    put(out, kFrames, now_ns, frame(now_ns, "map", name + "/start", T_map_start));
  }
  for (const RobotState& robot : robots) {
    const auto* pose = robot.line("pose").as<PoseLine>();
    if (pose == nullptr) continue;
    const auto& [x, y, theta] = pose->pose;
    put(out, kFrames, now_ns,
        frame(now_ns, robot.name() + "/start", robot.name() + "/base_link", {x, y, theta}));
  }
}

void FoxgloveSession::put_scene(std::vector<FoxgloveMessage>& out,
                                const std::vector<RobotState>& robots, std::size_t robot,
                                std::int64_t now_ns) const {
  const RobotState& own = robots[robot];
  json marks = entity(now_ns, own.name(), "landmarks");
  marks["spheres"] = spheres_of(own.landmarks(RobotState::kOwn), robot);
  json path = entity(now_ns, own.name(), "path");
  if (!own.path().empty()) path["lines"].push_back(line_of(own.path(), robot));
  put(out, scene_of(robot), now_ns,
      {{"deletions", json::array()}, {"entities", {std::move(marks), std::move(path)}}});
}

void FoxgloveSession::put_robot(std::vector<FoxgloveMessage>& out,
                                const std::vector<RobotState>& robots, std::size_t robot,
                                std::int64_t now_ns) {
  if (is_due(scene_of(robot), now_ns)) put_scene(out, robots, robot, now_ns);
  const auto& picture = robots[robot].picture();
  if (!picture || !wants_picture(robot)) return;
  const auto sent = pictures_.find(robot);
  if (sent != pictures_.end() && sent->second == picture->serial) return;
  if (sent == pictures_.end() && !is_due(image_of(robot), now_ns)) return;
  pictures_[robot] = picture->serial;
  std::string data(base64_size(picture->jpeg.size()), ' ');
  write_base64(picture->jpeg, data.data());
  put(out, image_of(robot), now_ns,
      {{"timestamp", stamp(now_ns)},
       {"frame_id", robots[robot].name() + "/base_link"},
       {"format", "jpeg"},
       {"data", data}});
}

std::vector<FoxgloveMessage> FoxgloveSession::turn(std::int64_t now_ns,
                                                   const std::vector<RobotState>& robots) {
  std::vector<FoxgloveMessage> out;
  if (auto channels = advertise(robots)) out.push_back(std::move(*channels));
  if (subscribed(kFrames)) put_frames(out, robots, now_ns);
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < robots.size() && bytes < kMostBytes; ++i) {
    const std::size_t before = out.size();
    put_robot(out, robots, first_, now_ns);
    for (std::size_t k = before; k < out.size(); ++k) bytes += out[k].bytes.size();
    first_ = (first_ + 1) % robots.size();
  }
  return out;
}

}  // namespace zenith::tools
