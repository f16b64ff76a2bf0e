#include "tools/view/pages.h"

#include <cstdio>
#include <string>
#include <utility>

#include "platform/linux/clock.h"
#include "platform/linux/log.h"
#include "tools/view/bounded_json.h"
#include "tools/view/jpeg.h"
#include "tools/view/player.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

constexpr Duration kSlice = {50'000'000};

// "127.0.0.1:8765/?token=0123456789abcdef"
std::string place_of(const WebOptions& options, const WebServer& server) {
  const bool any = options.bind == "0.0.0.0" || options.bind == "::" || options.bind == "[::]";
  std::string host = any ? "localhost" : options.bind;
  if (host.find(':') != std::string::npos && host[0] != '[') host = "[" + host + "]";
  host += ":" + std::to_string(server.port()) + "/";
  return server.token().empty() ? host : host + "?token=" + server.token();
}

void print_address(const WebOptions& options, const WebServer& server) {
  const std::string place = place_of(options, server);
  std::printf("Open http://%s in a browser.\nFoxglove: ws://%s   Ctrl-C ends.\n", place.c_str(),
              place.c_str());
  if (server.token().empty()) {
    std::printf("--no-token: everybody who reaches this address sees it all%s.\n",
                is_this_computer(options.bind) || options.bind == "[::1]"
                    ? ", every user of this computer"
                    : "");
  }
  std::fflush(stdout);
}

}  // namespace

LivePage::LivePage(const WebOptions& options, std::vector<RobotAddress> robots)
    : options_(options),
      state_(1, write_jpeg),
      live_(state_, std::move(robots),
            [this](std::size_t robot, const TelemetryLine& line, std::string_view text, Time now) {
              state_.read([&](const std::vector<RobotState>& states) {
                history_.note(robot, states[robot], line, text, now);
              });
            }),
      look_back_(state_, history_),
      before_(monotonic_now()) {
  state_.read([this](const std::vector<RobotState>& states) {
    for (const RobotState& robot : states) history_.add(robot.name());
  });
}

Result<std::unique_ptr<LivePage>> LivePage::start(const WebOptions& options,
                                                  std::vector<RobotAddress> robots) {
  std::unique_ptr<LivePage> page(new LivePage(options, std::move(robots)));
  auto server = WebServer::start(options, page->state_, [raw = page.get()](const json& request) {
    return raw->look_back_.answer(request);
  });
  if (!server.ok()) return server.error();
  page->server_ = std::move(*server);
  print_address(options, *page->server_);
  return page;
}

void LivePage::end(const std::string& why) {
  ended_ = true;
  for (std::size_t i = 0; i < state_.size(); ++i) state_.set_link(i, false, why);
}

std::string LivePage::address() const {
  return "http://" + place_of(options_, *server_);
}

void LivePage::turn(Duration wait, int wake_fd) {
  if (ended_) {
    sleep_until(monotonic_now() + wait);
  } else {
    live_.turn(wait, wake_fd);
  }
  const Time now = monotonic_now();
  look_back_.turn(now - before_);
  before_ = now;
  process_log().drain(now);
}

Status serve_replay(const WebOptions& options, Timeline timeline, Signals& signals) {
  FleetState state;
  const std::size_t player_refused = timeline.refused;
  Player player(state, std::move(timeline));
  const auto server = WebServer::start(options, state, [&](const json& request) {
    player.control(member(request, "control"));
    return state.answer(request);
  });
  if (!server.ok()) return server.error();
  print_address(options, **server);
  if (player_refused > 0) {
    log_line(LogLevel::kWarning, "%zu lines of the timeline were no telemetry and are left out",
             player_refused);
  }
  Time before = monotonic_now();
  while (signals.wait(kSlice) != SignalRequest::kStop) {
    const Time now = monotonic_now();
    player.play(now - before);
    before = now;
    process_log().drain(now);
  }
  return {};
}

}  // namespace zenith::tools
