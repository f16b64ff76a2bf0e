// zenith view: what robots see and think, in a browser.

#include <memory>
#include <string>
#include <vector>

#include "platform/linux/signals.h"
#include "platform/recording/layout.h"
#include "tools/commands.h"
#include "tools/progress.h"
#include "tools/replay.h"
#include "tools/scratch_folder.h"
#include "tools/view/pages.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHelp =
    R"(Serves a page on this computer alone: the map as it grows, what the camera sees, how sure the
robots are of each other, time, health and lights. It reads the daemon's telemetry socket; the daemon
itself opens no port, and does nothing more while nobody looks. Foxglove Studio and Lichtblick connect
to the same address as a WebSocket. Prometheus reads /metrics. docs/view.md has more.

The address ends in a token that keeps other users of this computer out; open it as it is printed.

WHAT is one or several robots: a telemetry socket, ssh:HOST or ssh:HOST:SOCKET for a robot elsewhere
(it runs `zenith telemetry` there); without any, the daemon on this computer. Or a replay: the output
folder of `zenith replay` or `zenith demo`, or recordings, which are mapped first.

Examples:
  zenith view
  zenith view ssh:anna ssh:bert
  zenith view out/demo
  zenith view rec/anna rec/bert)";

struct ViewCommand {
  std::vector<std::string> what;
  WebOptions web;
};

constexpr Duration kSlice = {50'000'000};

// Recordings that are mapped only to be looked at.
Result<Timeline> map_recordings(const std::vector<std::string>& recordings) {
  const ScratchFolder folder;
  ReplayPlan plan;
  for (const std::string& recording : recordings) plan.recordings.push_back(recording);
  Progress progress("mapping");
  const auto mapped =
      replay(plan, folder.path(), [&](double fraction) { progress.update(fraction); });
  if (!mapped.ok()) return mapped.error();
  return read_timeline(folder.path() / kTimelineFile);
}

int play(const ViewCommand& command, Timeline timeline, Signals& signals) {
  const Status served = serve_replay(command.web, std::move(timeline), signals);
  return served ? 0 : fail(served.error());
}

int listen(const ViewCommand& command, std::vector<RobotAddress> robots, Signals& signals) {
  const auto page = LivePage::start(command.web, std::move(robots));
  if (!page.ok()) return fail(page.error());
  while (signals.wait({0}) != SignalRequest::kStop) (*page)->turn(kSlice, signals.fd());
  return 0;
}

bool is_recording(const std::string& path) {
  return fs::exists(layout::frame_list(path));
}

int run_view(ViewCommand& command) {
  std::vector<std::string>& what = command.what;
  Signals signals;
  if (const Status opened = signals.open(); !opened) return fail(opened.error());
  if (what.size() == 1 && fs::is_directory(what[0]) && !is_recording(what[0])) {
    auto timeline = read_timeline(fs::path(what[0]) / kTimelineFile);
    if (!timeline.ok()) return fail(timeline.error());
    return play(command, std::move(*timeline), signals);
  }
  if (!what.empty() && is_recording(what[0])) {
    auto timeline = map_recordings(what);
    if (!timeline.ok()) return fail(timeline.error());
    return play(command, std::move(*timeline), signals);
  }
  if (what.empty()) what.push_back("");
  auto robots = parse_robot_addresses(what);
  if (!robots.ok()) return fail(robots.error());
  return listen(command, std::move(*robots), signals);
}

}  // namespace

void add_view_command(CLI::App& app, int& exit_code) {
  const auto command = std::make_shared<ViewCommand>();
  CLI::App* view = app.add_subcommand("view", "Look at robots, or a replay, in a browser");
  view->footer(kHelp);
  view->add_option("WHAT", command->what, "robots, or a replay");
  view->add_option("--port", command->web.port, "where the page is; 0: any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  view->add_option("--bind", command->web.bind,
                   "address to listen at, of IPv4 or IPv6; another than this computer's shows the "
                   "page to the network, unencrypted, to who has the token")
      ->capture_default_str();
  view->add_option("--allow-origin", command->web.origins,
                   "another web page that may read, such as https://app.foxglove.dev")
      ->allow_extra_args(false);
  view->add_option("--allow-host", command->web.hosts,
                   "a name of this computer by which the page may be asked, such as desk.local")
      ->allow_extra_args(false);
  CLI::Option* file =
      view->add_option("--token-file", command->web.token_file,
                       "the token stands in this file, which is made when it is not there; else "
                       "each start has a token of its own");
  view->add_flag("--no-token", command->web.no_token,
                 "no token: every user of this computer may look, with --bind all of the network")
      ->excludes(file);
  view->callback([command, &exit_code] { exit_code = run_view(*command); });
}

}  // namespace zenith::tools
