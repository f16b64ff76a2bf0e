// zenith demo: simulated robots, their maps merged, a picture. For whoever has no robot. As real
// daemons that talk over the network, or (--offline) recorded and mapped in this program.

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <sstream>
#include <string>
#include <thread>

#include "platform/linux/input_file.h"
#include "tools/atomic_output.h"
#include "tools/commands.h"
#include "tools/fleet/child_process.h"
#include "tools/fleet/demo.h"
#include "tools/progress.h"
#include "tools/replay.h"
#include "tools/report/figures_text.h"
#include "tools/report/map_picture.h"
#include "tools/scratch_folder.h"
#include "tools/simulate.h"
#include "tools/view/pages.h"

namespace zenith::tools {
namespace {

constexpr const char* kHelp =
    R"(Starts the robots of a world as daemons (zenithd-sim) that find each other on this computer's
loopback network, exchange their maps encrypted and join them when they are sure; watches them over
the same network and draws the merged map. Takes as long as the robots drive, about a minute for the
default world. Nothing else is needed: no robot, no camera, no data.

With --offline the same robots are recorded and mapped in this program alone, without a network:
repeatable bit for bit, with all figures, the confidence over time and recordings to try other
parameters on.

Examples:
  zenith demo
  zenith demo --view
  zenith demo --offline
  zenith demo --out /tmp/demo --seed 3
  zenith demo --world loop)";

struct DemoCommand {
  std::string out = "zenith-demo";
  std::string world = "corridor-rooms";
  std::uint64_t seed = 1;
  double duration_s = 0.0;
  bool offline = false;
  bool view = false;
  WebOptions web;
};

constexpr Duration kSlice = {50'000'000};

// The page of robots that run, turned by a thread of its own.
class PageThread {
 public:
  PageThread() = default;
  ~PageThread() { stop(); }
  PageThread(const PageThread&) = delete;
  PageThread& operator=(const PageThread&) = delete;

  Status start(const WebOptions& options, const std::vector<RobotAddress>& robots) {
    auto page = LivePage::start(options, robots);
    if (!page.ok()) return page.error();
    page_ = std::move(*page);
    run();
    open_browser();
    return {};
  }

  // The robots have ended; the page stays.
  void end() {
    stop();
    page_->end("the demo has ended");
    run();
  }

 private:
  void run() {
    stop_ = false;
    thread_ = std::thread([this] {
      while (!stop_) page_->turn(kSlice, -1);
    });
  }
  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  // Where there is a desktop; the address is printed anyway. A browser that it starts lives on.
  void open_browser() {
    if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
    // Command lines are seen by everybody on this computer, and the token shall not be: it stands
    // in a file of this user's that leads on.
    door_ = std::make_unique<ScratchFolder>();
    const std::string leads = (door_->path() / "zenith.html").string();
    const std::string text =
        "<!doctype html><meta http-equiv=\"refresh\" content=\"0;url=" + page_->address() + "\">\n";
    if (door_->path().empty() || !write_file(leads, text)) return;
    auto opener = ChildProcess::start({"setsid", "--fork", "xdg-open", leads}, "/dev/null");
    if (opener.ok()) opener_ = std::make_unique<ChildProcess>(std::move(*opener));
  }

  std::unique_ptr<ScratchFolder> door_;
  std::unique_ptr<LivePage> page_;
  std::unique_ptr<ChildProcess> opener_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

Result<ReplayResult> simulate_and_map(const DemoCommand& command,
                                      const std::filesystem::path& folder) {
  ReplayPlan plan;
  plan.seed = command.seed;
  std::vector<std::string> names;
  {
    std::printf("1. Robots drive through '%s' and record what they see ...\n",
                command.world.c_str());
    std::fflush(stdout);
    Progress progress("simulating");
    auto written =
        write_simulation({command.world, command.seed, command.duration_s}, folder / "recordings",
                         [&](double fraction) { progress.update(fraction); });
    if (!written.ok()) return written.error();
    names = std::move(*written);
  }
  for (const std::string& name : names) plan.recordings.push_back(folder / "recordings" / name);
  std::printf(
      "2. Each maps the ceiling from its own start and tells the others its landmarks ...\n");
  std::fflush(stdout);
  Progress progress("mapping");
  return replay(plan, folder, [&](double fraction) { progress.update(fraction); });
}

constexpr std::uint64_t kMaxLogBytes = std::uint64_t{16} << 20U;

// What daemons said, when something went wrong.
std::string daemon_logs(const std::filesystem::path& folder) {
  std::string text;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".log") continue;
    const auto content = read_input(entry.path().string(), kMaxLogBytes);
    text += entry.path().filename().string() + ":\n" +
            (content ? *content : content.error().message + "\n");
  }
  return text;
}

void print_result(const std::filesystem::path& out, const TeamFigures& figures) {
  const auto file = [&](const char* name) { return (out / name).lexically_normal().string(); };
  std::printf("3. Done.\n\n%s\n", figures_text(figures).c_str());
  std::printf("Open these:\n");
  std::printf("  %-44s the merged map, with the true paths in grey\n", file("map.png").c_str());
  if (std::filesystem::exists(out / "confidence.png")) {
    std::printf("  %-44s how sure the robots grew that their maps overlap\n",
                file("confidence.png").c_str());
  }
  std::printf("  %-44s how it grew, in a browser\n",
              ("zenith view " + out.lexically_normal().string()).c_str());
  std::printf("  %-44s all figures\n", file("summary.json").c_str());
  std::printf("  %-44s the recordings, for `zenith replay`\n", file("recordings").c_str());
}

double degrees(double rad) {
  return rad * 180.0 / std::numbers::pi;
}

void print_pairs(const TeamLog& log, const TeamFigures& figures) {
  for (const PairFigures& pair : figures.pairs) {
    const std::string& own = log.robots[static_cast<std::size_t>(pair.own)].name;
    const std::string& peer = log.robots[static_cast<std::size_t>(pair.peer)].name;
    if (!pair.merged_at_end || !pair.at_end) {
      std::printf("   %s and %s's map: not joined at the end\n", own.c_str(), peer.c_str());
      continue;
    }
    std::printf(
        "   %s and %s's map: joined %.0f s after it had its first pose; it knows\n      where %s "
        "started to %.1f cm and %.2f "
        "degrees\n",
        own.c_str(), peer.c_str(), pair.merge_time_s.value_or(0.0), peer.c_str(),
        100.0 * pair.at_end->position_m, degrees(pair.at_end->angle_rad));
  }
}

// The figures that need the truth of every frame are not there: robots do not tell their stamps.
void drop_paths(TeamFigures& figures) {
  for (RobotFigures& robot : figures.robots) {
    robot.ate_m.reset();
    robot.odometry_ate_m.reset();
    robot.true_path_m.reset();
    robot.loop.reset();
  }
}

int run_live(const DemoCommand& command) {
  auto output = AtomicFolder::create(command.out, true, "summary.json");
  if (!output.ok()) return fail(output.error());
  std::printf("1. Robots start as daemons in '%s', each in a map of its own ...\n",
              command.world.c_str());
  Signals signals;
  PageThread page;
  FleetDemo demo = {command.world, command.seed, command.duration_s};
  if (command.view) {
    if (const Status opened = signals.open(); !opened) return fail(opened.error());
    demo.on_start = [&](const auto& robots) { return page.start(command.web, robots); };
    demo.stopped = [&] { return signals.wait({0}) == SignalRequest::kStop; };
  }
  auto log = run_fleet_demo(demo, output->path());
  if (!log.ok()) {
    std::printf("%s", daemon_logs(output->path()).c_str());
    return fail(log.error());
  }
  std::printf("2. All have driven their ways. The maps, held against the truth:\n");
  TeamFigures figures = judge(*log);
  drop_paths(figures);
  for (RobotLog& robot : log->robots) robot.frames.front().truth.reset();  // one point is no path
  print_pairs(*log, figures);
  if (const Status drawn = draw_map(output->path() / "map.png", *log, figures); !drawn) {
    return fail(drawn.error());
  }
  const std::string summary = figures_json(figures).dump(2) + "\n";
  if (const Status w = write_file(output->path() / "summary.json", summary); !w) {
    return fail(w.error());
  }
  if (const Status placed = output->commit(); !placed) return fail(placed.error());
  const auto file = [&](const char* name) {
    return (std::filesystem::path(command.out) / name).lexically_normal().string();
  };
  std::printf("3. Open these:\n");
  std::printf("   %-36s the merged map\n", file("map.png").c_str());
  std::printf(
      "   %-36s how it grew, in a browser\n",
      ("zenith view " + std::filesystem::path(command.out).lexically_normal().string()).c_str());
  std::printf("   %-36s what a robot logged\n",
              file((log->robots[0].name + ".log").c_str()).c_str());
  std::printf("   %-36s its configuration\n",
              file((log->robots[0].name + ".toml").c_str()).c_str());
  if (command.view) {
    page.end();
    std::printf(
        "The robots have ended; the page still shows them, and looks back. Ctrl-C ends it.\n");
    std::fflush(stdout);
    while (signals.wait(kSlice) != SignalRequest::kStop) {
    }
  }
  return 0;
}

int run_demo(const DemoCommand& command) {
  if (const Status known = check_worlds({command.world}); !known) return fail(known.error());
  if (!command.offline) return run_live(command);
  auto output = AtomicFolder::create(command.out, true, "summary.json");
  if (!output.ok()) return fail(output.error());
  const auto result = simulate_and_map(command, output->path());
  if (!result.ok()) return fail(result.error());
  if (const Status placed = output->commit(); !placed) return fail(placed.error());
  warn(result->warnings);
  print_result(command.out, result->figures);
  if (!command.view) return 0;
  auto timeline = read_timeline(std::filesystem::path(command.out) / kTimelineFile);
  if (!timeline.ok()) return fail(timeline.error());
  Signals signals;
  if (const Status opened = signals.open(); !opened) return fail(opened.error());
  const Status served = serve_replay(command.web, std::move(*timeline), signals);
  return served ? 0 : fail(served.error());
}

}  // namespace

void add_demo_command(CLI::App& app, int& exit_code) {
  const auto command = std::make_shared<DemoCommand>();
  CLI::App* demo = app.add_subcommand("demo", "Two simulated robots, one map, a picture");
  demo->footer(kHelp);
  demo->add_option("--out", command->out, "the folder to write; an older demo there is replaced")
      ->capture_default_str();
  demo->add_option("--world", command->world, "a world of `zenith sim --list`, or a file")
      ->capture_default_str();
  demo->add_option("--seed", command->seed, "another seed, another drive")->capture_default_str();
  demo->add_option("--duration", command->duration_s, "seconds to drive at most, 0: all")
      ->check(CLI::NonNegativeNumber);
  demo->add_flag("--offline", command->offline,
                 "no daemons and no network: record, then map the recordings");
  demo->add_flag(
      "--view", command->view,
      "show it in a browser meanwhile, and until Ctrl-C (offline: afterwards); opens one where "
      "there is a desktop");
  demo->add_option("--port", command->web.port, "where the page of --view is; 0: any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  demo->callback([command, &exit_code] { exit_code = run_demo(*command); });
}

}  // namespace zenith::tools
