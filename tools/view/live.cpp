#include "tools/view/live.h"

#include <poll.h>

#include "platform/linux/clock.h"
#include "platform/linux/log.h"

namespace zenith::tools {
namespace {

// A daemon tells pictures for three seconds after it was asked.
constexpr Duration kAskEvery = {1'000'000'000};
constexpr Duration kLogEvery = {60'000'000'000};

}  // namespace

Live::Live(FleetState& state, std::vector<RobotAddress> robots, Heard heard)
    : state_(state), heard_(std::move(heard)) {
  for (RobotAddress& robot : robots) {
    const std::size_t number = state_.add(robot.text.empty() ? "robot" : robot.text);
    links_.emplace_back(std::move(robot));
    next_log_.emplace_back();
    state_.set_link(number, false, links_.back().why());
  }
}

void Live::take(std::size_t robot, std::string_view text, Time now) {
  const DecodedLine decoded = decode_telemetry(text);
  if (!decoded.line) return refuse(robot, decoded, now);
  state_.apply(robot, *decoded.line);
  if (heard_) heard_(robot, *decoded.line, text, now);
}

void Live::refuse(std::size_t robot, const DecodedLine& decoded, Time now) {
  state_.count_refused(robot, decoded.fault);
  Time& next = next_log_[robot][static_cast<std::size_t>(decoded.fault)];
  if (now < next) return;
  next = now + kLogEvery;
  log_line(LogLevel::kWarning, "%s: a line of its telemetry was skipped: %s %s",
           links_[robot].address().c_str(), fault_name(decoded.fault), decoded.field.c_str());
}

void Live::turn(Duration wait, int wake_fd) {
  std::vector<pollfd> entries = {{wake_fd, POLLIN, 0}};
  for (const TelemetryLink& link : links_) entries.push_back({link.fd(), POLLIN, 0});
  (void)::poll(entries.data(), entries.size(), static_cast<int>(wait.ns / 1'000'000));
  const Time now = monotonic_now();
  const bool may_ask = now >= next_wish_;
  if (may_ask) next_wish_ = now + kAskEvery;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const bool changed = links_[i].turn(now, [&](std::string_view text) { take(i, text, now); });
    if (changed) state_.set_link(i, links_[i].up(), links_[i].why());
    if (may_ask && state_.take_wish(i)) links_[i].ask_picture();
  }
}

}  // namespace zenith::tools
