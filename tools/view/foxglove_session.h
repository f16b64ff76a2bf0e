#pragma once
// One viewer that speaks Foxglove's WebSocket protocol, version 1 (Foxglove Studio, Lichtblick):
// what to send it, without a socket and without a clock.
//
//   /tf             foxglove.FrameTransform   map -> NAME/start -> NAME/base_link
//   /NAME/scene     foxglove.SceneUpdate      landmarks and path, once a second
//   /NAME/image     foxglove.CompressedImage  the level image, while somebody subscribes
//
// `map` is the start frame of the first robot; a robot's start has a place in it once it is merged.
// Messages are JSON. One thread at a time.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/view/robot_state.h"
#include "tools/view/web_connection.h"

namespace zenith::tools {

using FoxgloveMessage = WebMessage;

class FoxgloveSession {
 public:
  // Of one turn; what is left comes with the next ones.
  static constexpr std::size_t kMostBytes = std::size_t{8} << 20U;

  // What a viewer that has just connected gets.
  static FoxgloveMessage server_info();

  // A text from the viewer. Not understood: passed over. A channel has one subscription, the
  // latest.
  void receive(std::string_view text);
  // What is to be sent now; call some ten times a second. `now_ns` rises.
  std::vector<FoxgloveMessage> turn(std::int64_t now_ns, const std::vector<RobotState>& robots);
  // Whether the viewer shows the pictures of this robot.
  bool wants_picture(std::size_t robot) const;

 private:
  using Channel = std::uint32_t;

  std::optional<FoxgloveMessage> advertise(const std::vector<RobotState>& robots);
  void put(std::vector<FoxgloveMessage>& out, Channel channel, std::int64_t stamp_ns,
           const nlohmann::json& message) const;
  void put_frames(std::vector<FoxgloveMessage>& out, const std::vector<RobotState>& robots,
                  std::int64_t now_ns);
  void put_scene(std::vector<FoxgloveMessage>& out, const std::vector<RobotState>& robots,
                 std::size_t robot, std::int64_t now_ns) const;
  bool subscribed(Channel channel) const { return subscriptions_.count(channel) > 0; }
  bool is_due(Channel channel, std::int64_t now_ns);
  void put_robot(std::vector<FoxgloveMessage>& out, const std::vector<RobotState>& robots,
                 std::size_t robot, std::int64_t now_ns);

  std::map<std::size_t, std::string> advertised_;   // robots, by the name that was told
  std::map<Channel, std::uint32_t> subscriptions_;  // the viewer's number of each channel
  std::map<std::size_t, std::uint64_t> pictures_;   // serials that were sent
  std::map<Channel, std::int64_t> next_ns_;         // of scenes; and of pictures sent once more
  std::size_t first_ = 0;                           // the robot whose turn is next
};

// {"title": .., "type": "object", "properties": ..} of one of Foxglove's types.
std::string foxglove_schema(const std::string& name);

}  // namespace zenith::tools
