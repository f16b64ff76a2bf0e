// zenith metrics: what Prometheus reads, once or again and again.

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "platform/linux/clock.h"
#include "platform/linux/log.h"
#include "platform/linux/signals.h"
#include "tools/atomic_output.h"
#include "tools/commands.h"
#include "tools/view/live.h"
#include "tools/view/metrics.h"

namespace zenith::tools {
namespace {

constexpr const char* kHelp =
    R"(Writes the robots' metrics in Prometheus' text format: to standard output, or with --textfile
into a file that appears whole or not at all, as the node exporter's textfile collector wants it.
docs/metrics.md lists them. A robot is given as for `zenith view`.

Examples:
  zenith metrics
  zenith metrics --textfile /var/lib/prometheus/node-exporter/zenith.prom --every 15
  zenith metrics ssh:anna ssh:bert)";

struct MetricsCommand {
  std::vector<std::string> robots;
  std::string textfile;
  double every_s = 0.0;
};

constexpr Duration kPatience = {4'000'000'000};
constexpr Duration kSlice = {100'000'000};

// All has been told once. `zenith_up` tells of those that are missing.
bool complete(const FleetState& state) {
  bool all = true;
  state.read([&](const std::vector<RobotState>& robots) {
    for (const RobotState& robot : robots) {
      for (const char* line : {"health", "deadlines", "radio"}) {
        all = all && !robot.line(line).empty();
      }
    }
  });
  return all;
}

Status put(const MetricsCommand& command, const FleetState& state) {
  const std::string text = metrics_text(state);
  if (!command.textfile.empty()) return write_file(command.textfile, text);
  std::printf("%s", text.c_str());
  std::fflush(stdout);
  return {};
}

int run_metrics(const MetricsCommand& command) {
  auto robots = parse_robot_addresses(command.robots);
  if (!robots.ok()) return fail(robots.error());
  Signals signals;
  if (const Status opened = signals.open(); !opened) return fail(opened.error());
  FleetState state;
  Live live(state, std::move(*robots));
  const Time limit = monotonic_now() + kPatience;
  while (!complete(state) && monotonic_now() < limit) {
    if (signals.wait({0}) == SignalRequest::kStop) return 1;
    live.turn(kSlice, signals.fd());
    process_log().drain(monotonic_now());
  }
  const bool heard = complete(state);
  if (!heard && command.every_s <= 0.0) {
    warn({"not all robots told all within four seconds: zenith_up says which"});
  }
  while (true) {
    if (const Status written = put(command, state); !written) return fail(written.error());
    if (command.every_s <= 0.0) return heard ? 0 : 1;
    const Time next = monotonic_now() + Duration::from_seconds(command.every_s);
    while (monotonic_now() < next) {
      if (signals.wait({0}) == SignalRequest::kStop) return 0;
      live.turn(kSlice, signals.fd());
      process_log().drain(monotonic_now());
    }
  }
}

}  // namespace

void add_metrics_command(CLI::App& app, int& exit_code) {
  const auto command = std::make_shared<MetricsCommand>();
  command->robots = {""};
  CLI::App* metrics = app.add_subcommand("metrics", "Metrics for Prometheus");
  metrics->footer(kHelp);
  metrics->add_option("ROBOT", command->robots,
                      "telemetry sockets, or ssh:HOST; without any the usual places of this "
                      "computer");
  metrics->add_option("--textfile", command->textfile, "the file to write");
  metrics->add_option("--every", command->every_s, "seconds, again and again; 0: once")
      ->check(CLI::NonNegativeNumber);
  metrics->callback([command, &exit_code] { exit_code = run_metrics(*command); });
}

}  // namespace zenith::tools
