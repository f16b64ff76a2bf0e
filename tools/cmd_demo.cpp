// zenith demo: simulated robots, their maps merged, a picture. For whoever has no robot.

#include <cstdio>
#include <memory>
#include <string>

#include "tools/atomic_output.h"
#include "tools/commands.h"
#include "tools/progress.h"
#include "tools/replay.h"
#include "tools/report/figures_text.h"
#include "tools/simulate.h"

namespace zenith::tools {
namespace {

constexpr const char* kHelp =
    R"(Simulates the robots of a world, records what they see, maps the recordings together and
draws the merged map. Nothing else is needed: no robot, no camera, no data.

Examples:
  zenith demo
  zenith demo --out /tmp/demo --seed 3
  zenith demo --world loop)";

struct DemoCommand {
  std::string out = "zenith-demo";
  std::string world = "corridor-rooms";
  std::uint64_t seed = 1;
  double duration_s = 0.0;
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

void print_result(const std::filesystem::path& out, const TeamFigures& figures) {
  const auto file = [&](const char* name) { return (out / name).lexically_normal().string(); };
  std::printf("3. Done.\n\n%s\n", figures_text(figures).c_str());
  std::printf("Open these:\n");
  std::printf("  %-44s the merged map, with the true paths in grey\n", file("map.png").c_str());
  if (std::filesystem::exists(out / "confidence.png")) {
    std::printf("  %-44s how sure the robots grew that their maps overlap\n",
                file("confidence.png").c_str());
  }
  std::printf("  %-44s all figures\n", file("summary.json").c_str());
  std::printf("  %-44s the recordings, for `zenith replay`\n", file("recordings").c_str());
}

int run_demo(const DemoCommand& command) {
  if (const Status known = check_worlds({command.world}); !known) return fail(known.error());
  auto output = AtomicFolder::create(command.out, true, "summary.json");
  if (!output.ok()) return fail(output.error());
  const auto result = simulate_and_map(command, output->path());
  if (!result.ok()) return fail(result.error());
  if (const Status placed = output->commit(); !placed) return fail(placed.error());
  warn(result->warnings);
  print_result(command.out, result->figures);
  return 0;
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
  demo->callback([command, &exit_code] { exit_code = run_demo(*command); });
}

}  // namespace zenith::tools
