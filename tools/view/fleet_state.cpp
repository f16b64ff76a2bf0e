#include "tools/view/fleet_state.h"

#include "platform/base/base64.h"
#include "tools/view/bounded_json.h"

namespace zenith::tools {
namespace {

using nlohmann::json;
using Lock = std::lock_guard<std::recursive_mutex>;

std::string data_url(const std::vector<unsigned char>& jpeg) {
  std::string text(base64_size(jpeg.size()), ' ');
  write_base64(jpeg, text.data());
  return "data:image/jpeg;base64," + text;
}

}  // namespace

std::size_t FleetState::add(const std::string& label) {
  const Lock lock(mutex_);
  robots_.emplace_back(label, write_jpeg_);
  wishes_.push_back(false);
  return robots_.size() - 1;
}

std::size_t FleetState::size() const {
  const Lock lock(mutex_);
  return robots_.size();
}

void FleetState::apply(std::size_t robot, const TelemetryLine& line) {
  const Lock lock(mutex_);
  if (robots_[robot].apply(line, ++version_)) ++epoch_;
}

void FleetState::count_refused(std::size_t robot, LineFault fault) {
  const Lock lock(mutex_);
  robots_[robot].count_refused(fault, ++version_);
}

void FleetState::set_link(std::size_t robot, bool up, const std::string& why) {
  const Lock lock(mutex_);
  robots_[robot].set_link(up, why, ++version_);
}

void FleetState::rebuild(const std::function<void()>& build) {
  const Lock lock(mutex_);
  ++epoch_;
  ++version_;
  for (RobotState& robot : robots_) robot.clear(version_);
  build();
}

void FleetState::set_clock(const json& clock) {
  const Lock lock(mutex_);
  clock_ = clock;
}

void FleetState::read(const std::function<void(const std::vector<RobotState>&)>& reader) const {
  const Lock lock(mutex_);
  reader(robots_);
}

void FleetState::wish(std::size_t robot) {
  const Lock lock(mutex_);
  wishes_[robot] = true;
}

bool FleetState::take_wish(std::size_t robot) {
  const Lock lock(mutex_);
  const bool wished = wishes_[robot];
  wishes_[robot] = false;
  return wished;
}

json FleetState::answer(const json& request) {
  const Lock lock(mutex_);
  const auto number = [&](const char* key) {
    return static_cast<std::uint64_t>(
        read_integer(member(request, key), 0, std::numeric_limits<std::int64_t>::max())
            .value_or(0));
  };
  const bool all = number("epoch") != epoch_;
  const std::uint64_t seen = all ? 0 : number("seen");
  json out = {{"epoch", epoch_}, {"seen", version_}, {"reset", all}, {"clock", clock_}};
  json& robots = out["robots"] = json::array();
  const auto picture = read_integer(member(request, "picture"), 0, kMostRobots);
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    json changes = robots_[i].changes(seen);
    if (changes.is_null()) changes = json::object();
    changes["name"] = robots_[i].name();
    if (picture && static_cast<std::size_t>(*picture) == i) {
      wishes_[i] = true;
      const auto& last = robots_[i].picture();
      if (last && last->serial != number("picture_seen")) {
        changes["picture"] = last->told;
        changes["picture"]["serial"] = last->serial;
        changes["picture"]["image"] = data_url(last->jpeg);
      }
    }
    robots.push_back(std::move(changes));
  }
  return out;
}

}  // namespace zenith::tools
