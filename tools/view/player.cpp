#include "tools/view/player.h"

#include <algorithm>
#include <vector>

#include "tools/view/bounded_json.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

constexpr double kSlowest = 0.1;
constexpr double kFastest = 20.0;

}  // namespace

Player::Player(FleetState& state, Timeline timeline)
    : state_(state), timeline_(std::move(timeline)) {
  for (const std::string& robot : timeline_.robots) {
    state_.set_link(state_.add(robot), true, "");
  }
  tell_clock();
}

void Player::play(Duration elapsed) {
  const std::lock_guard lock(mutex_);
  if (!playing_) return;
  advance(std::min(position_s_ + elapsed.seconds() * speed_, timeline_.duration_s));
  playing_ = position_s_ < timeline_.duration_s;
  tell_clock();
}

void Player::control(const json& asked) {
  const std::lock_guard lock(mutex_);
  if (const auto speed = read_number(member(asked, "speed"))) {
    speed_ = std::clamp(*speed, kSlowest, kFastest);
  }
  if (const auto to_s = read_number(member(asked, "seek"))) {
    seek(std::clamp(*to_s, 0.0, timeline_.duration_s));
  }
  if (const auto play = read_flag(member(asked, "play"))) {
    playing_ = *play;
    if (playing_ && position_s_ >= timeline_.duration_s) seek(0.0);
  }
  tell_clock();
}

void Player::seek(double to_s) {
  if (to_s >= position_s_) return advance(to_s);
  state_.rebuild([&] {
    next_ = 0;
    begun_ = false;
    advance(to_s);
  });
}

void Player::advance(double to_s) {
  position_s_ = to_s;
  if (!begun_) {
    for (const auto& [robot, line] : timeline_.before) state_.apply(robot, line);
  }
  begun_ = true;
  const std::size_t first = next_;
  while (next_ < timeline_.entries.size() && timeline_.entries[next_].t_s <= to_s) ++next_;
  // Of each robot's pictures the last one alone is seen.
  std::vector<std::size_t> pictures(timeline_.robots.size(), next_);
  for (std::size_t i = first; i < next_; ++i) {
    if (timeline_.entries[i].is_picture) pictures[timeline_.entries[i].robot] = i;
  }
  for (std::size_t i = first; i < next_; ++i) {
    const Timeline::Entry& entry = timeline_.entries[i];
    if (entry.is_picture && pictures[entry.robot] != i) continue;
    const DecodedLine decoded = timeline_.line_of(entry);
    if (decoded.line) state_.apply(entry.robot, *decoded.line);
  }
}

void Player::tell_clock() {
  json marks = json::array();
  for (const Timeline::Mark& mark : timeline_.marks) {
    marks.push_back({{"t_s", mark.t_s}, {"text", mark.text}});
  }
  state_.set_clock({{"position_s", position_s_},
                    {"duration_s", timeline_.duration_s},
                    {"playing", playing_},
                    {"speed", speed_},
                    {"marks", marks}});
}

}  // namespace zenith::tools
