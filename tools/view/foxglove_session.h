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
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/view/robot_state.h"

namespace zenith::tools {

struct FoxgloveMessage {
  bool binary = false;
  std::string bytes;
};

class FoxgloveSession {
 public:
  // What a viewer that has just connected gets.
  static FoxgloveMessage server_info();

  // A text from the viewer. Not understood: passed over.
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
  bool subscribed(Channel channel) const;

  std::map<std::size_t, std::string> advertised_;   // robots, by the name that was told
  std::map<std::uint32_t, Channel> subscriptions_;  // by the viewer's number
  std::map<std::size_t, std::uint64_t> pictures_;   // serials that were sent
  std::set<Channel> fresh_;                         // subscribed since the last turn
  std::int64_t next_scene_ns_ = 0;
};

// {"title": .., "type": "object", "properties": ..} of one of Foxglove's types.
std::string foxglove_schema(const std::string& name);

}  // namespace zenith::tools
