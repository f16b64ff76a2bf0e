#include "tools/ros2/bridge.h"

#include <algorithm>
#include <set>

#include "platform/linux/clock.h"
#include "platform/linux/log.h"
#include "tools/view/placement.h"

namespace zenith::ros2 {
namespace {

using tools::RobotState;

constexpr Duration kSecond = {1'000'000'000};

std::int64_t system_now_ns() {
  return (monotonic_now() + system_clock_offset()).ns;
}

// Whose map each slot holds, as far as it is told.
std::map<int, std::string> owners(const RobotState& state) {
  std::map<int, std::string> out;
  for (const auto& [key, line] : state.lines()) {
    const auto* alignment = line.as<tools::AlignmentLine>();
    const auto* peer = line.as<tools::PeerLine>();
    if (alignment == nullptr && peer == nullptr) continue;
    const int slot = alignment != nullptr ? alignment->slot : peer->slot;
    const std::string& name = alignment != nullptr ? alignment->name : peer->name;
    if (slot >= 0 && name != tools::kEarlierSession) out[slot] = name;
  }
  return out;
}

bool same(const std::vector<FrameTransform>& a, const std::vector<FrameTransform>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const FrameTransform& x, const FrameTransform& y) {
                      const Pose2& p = x.T_parent_child;
                      const Pose2& q = y.T_parent_child;
                      return x.parent == y.parent && x.child == y.child && p.x_m == q.x_m &&
                             p.y_m == q.y_m && p.theta_rad == q.theta_rad;
                    });
}

}  // namespace

Bridge::Bridge(const BridgeOptions& options, std::vector<tools::RobotAddress> robots)
    : options_(options),
      robots_(robots.size()),
      live_(state_, std::move(robots),
            [this](std::size_t robot, const tools::TelemetryLine& line, std::string_view, Time) {
              hear(robot, line);
            }) {}

Result<std::unique_ptr<Bridge>> Bridge::start(const BridgeOptions& options,
                                              std::vector<tools::RobotAddress> robots) {
  std::unique_ptr<Bridge> bridge(new Bridge(options, std::move(robots)));
  if (const Status opened = bridge->open(); !opened) return opened.error();
  return bridge;
}

Status Bridge::open() {
  auto participant = Participant::join(options_.domain, options_.localhost);
  if (!participant) return participant.error();
  participant_ = std::move(*participant);
  auto transforms = Transforms::make(*participant_);
  if (!transforms) return transforms.error();
  transforms_ = std::move(*transforms);
  auto diagnostics = Diagnostics::make(*participant_);
  if (!diagnostics) return diagnostics.error();
  diagnostics_ = std::move(*diagnostics);
  next_second_ = monotonic_now() + kSecond;  // robots have that time to answer
  return {};
}

void Bridge::turn(Duration wait, int wake_fd) {
  live_.turn(wait, wake_fd);
  const Time now = monotonic_now();
  if (now < next_second_) return;
  next_second_ = now + kSecond;
  std::vector<Diagnosis> all;
  state_.read([&](const std::vector<RobotState>& states) {
    note_links(states);
    for (const RobotState& state : states) {
      for (Diagnosis& diagnosis : diagnose(state)) all.push_back(std::move(diagnosis));
    }
  });
  note(diagnostics_->tell(system_now_ns(), all));
}

void Bridge::hear(std::size_t number, const tools::TelemetryLine& line) {
  Robot& robot = robots_[number];
  if (line.system_offset_ns()) robot.system_offset_ns = *line.system_offset_ns();
  if (const auto* hello = line.as<tools::HelloLine>()) greet(robot, hello->robot);
  if (robot.topics == nullptr) return;
  const auto* alignment = line.as<tools::AlignmentLine>();
  if (line.as<tools::PoseLine>() != nullptr) {
    tell_motion(robot, line);
  } else if (alignment != nullptr && alignment->name != tools::kEarlierSession) {
    note(robot.topics->tell_alignment(system_stamp(line, robot.system_offset_ns), *alignment));
  } else if (line.type() == "radio") {
    state_.read([&](const std::vector<RobotState>& states) {
      tell_maps(robot, states[number]);
      tell_peers_frames(states);
    });
  }
}

// Topics are made when a robot has said its name, and again when it has another one.
void Bridge::greet(Robot& robot, const std::string& name) {
  RobotNames names(name, options_.frames, options_.prefixed);
  robot.maps.clear();
  robot.told_ns = 0;
  if (robot.topics != nullptr && robot.topics->names().robot() == names.robot()) return;
  robot.topics.reset();
  const bool taken = std::any_of(robots_.begin(), robots_.end(), [&](const Robot& other) {
    return other.topics != nullptr && other.topics->names().robot() == names.robot();
  });
  if (taken) {
    return note(Error{"two robots say that they are " + name +
                      ": no topics for the second; give it another name"});
  }
  auto made = RobotTopics::make(*participant_, std::move(names));
  if (!made) return note(made.error());
  robot.topics = std::move(*made);
}

void Bridge::tell_motion(Robot& robot, const tools::TelemetryLine& line) {
  const auto motion = read_motion(line, robot.system_offset_ns);
  if (!motion || robot.system_offset_ns == 0) {
    if (!robot.odometry_missed) {
      log_line(LogLevel::kWarning,
               "robot %s tells poses without odometry or clock: is its zenithd older than this "
               "bridge? Nothing is published of its motion",
               robot.topics->names().robot().c_str());
    }
    robot.odometry_missed = true;
    return;
  }
  robot.told_ns = motion->system_ns;
  note(robot.topics->tell_motion(*motion));
  if (!options_.transforms) return;
  const RobotNames& names = robot.topics->names();
  note(transforms_->send({{motion->system_ns, names.map(), names.odom(), motion->T_map_odom()},
                          {motion->system_ns, names.odom(), names.base(), motion->T_odom_base}}));
}

void Bridge::tell_maps(Robot& robot, const RobotState& state) {
  const std::int64_t stamp = robot.told_ns != 0 ? robot.told_ns : system_now_ns();
  const auto is_new = [&](int owner) {
    std::uint64_t& told = robot.maps[owner];
    const bool changed = state.landmarks_version(owner) != told;
    told = state.landmarks_version(owner);
    return changed;
  };
  if (is_new(RobotState::kOwn)) {
    note(robot.topics->tell_landmarks(stamp, state.landmarks(RobotState::kOwn)));
  }
  for (const auto& [slot, name] : owners(state)) {
    if (is_new(slot)) {
      note(robot.topics->tell_peer_landmarks(name, stamp, state.landmarks(slot)));
    }
  }
}

// Trees of maps that are one: below the first robot's of each, all others'.
void Bridge::tell_peers_frames(const std::vector<RobotState>& states) {
  if (!options_.peers_transforms) return;
  std::vector<FrameTransform> fixed;
  std::set<std::string> placed;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (robots_[i].topics == nullptr || placed.count(states[i].name()) != 0) continue;
    const RobotNames& root = robots_[i].topics->names();
    for (const auto& [name, T_root_other] : tools::place_starts(states, i)) {
      placed.insert(name);
      if (name == states[i].name()) continue;
      fixed.push_back({system_now_ns(), root.map(), root.map_of(name), T_root_other});
    }
  }
  if (same(fixed, fixed_)) return;
  fixed_ = fixed;
  note(transforms_->send_static(fixed));
}

void Bridge::note_links(const std::vector<RobotState>& states) {
  for (std::size_t i = 0; i < states.size(); ++i) {
    Robot& robot = robots_[i];
    const std::string why = states[i].up() ? "" : states[i].line("link").text("/why");
    if (robot.linked == states[i].up() && robot.link == why) continue;
    robot.linked = states[i].up();
    robot.link = why;
    if (robot.linked) {
      log_line(LogLevel::kNotice, "robot %s is heard", states[i].name().c_str());
    } else {
      log_line(LogLevel::kWarning, "robot %s is not heard: %s", states[i].name().c_str(),
               why.c_str());
    }
  }
}

void Bridge::note(const Status& written) {
  if (!written) log_lines(LogLevel::kWarning, written.error().message);
}

}  // namespace zenith::ros2
