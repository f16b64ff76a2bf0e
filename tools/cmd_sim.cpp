// zenith sim: recordings of simulated robots.

#include <cstdio>
#include <memory>
#include <string>

#include "sim/simulation.h"
#include "tools/atomic_output.h"
#include "tools/commands.h"
#include "tools/progress.h"
#include "tools/simulate.h"

namespace zenith::tools {
namespace {

constexpr const char* kHelp =
    R"(Drives the robots of a world through it and records what their cameras and wheels
deliver, with the ground truth: one folder for each robot, as `zenith replay` reads them. The
folder appears when everything is written; an existing one is replaced only with --force.

Examples:
  zenith sim --list
  zenith sim corridor-rooms --out rec
  zenith sim corridor-rooms --out rec --seed 7 --duration 60
  zenith sim my-world.toml --out rec --force)";

struct SimCommand {
  SimulatePlan plan;
  std::string out;
  bool list = false;
  bool force = false;
};

int list_worlds() {
  for (const std::string& name : sim::list_worlds()) std::printf("%s\n", name.c_str());
  return 0;
}

int run_sim(const SimCommand& command) {
  if (command.list) return list_worlds();
  if (command.plan.world.empty()) {
    return fail({"sim needs a WORLD: one of `zenith sim --list`, or a file"}) + 1;
  }
  if (command.out.empty()) return fail({"sim needs a folder to write to: --out DIR"}) + 1;
  if (const Status known = check_worlds({command.plan.world}); !known) return fail(known.error());
  auto output = AtomicFolder::create(command.out, command.force, "simulation.json");
  if (!output.ok()) return fail(output.error());
  const auto names = [&] {
    Progress progress("simulating " + command.plan.world);
    return write_simulation(command.plan, output->path(),
                            [&](double fraction) { progress.update(fraction); });
  }();
  if (!names.ok()) return fail(names.error());
  if (const Status placed = output->commit(); !placed) return fail(placed.error());
  for (const std::string& name : *names) {
    std::printf("%s\n", (std::filesystem::path(command.out) / name).c_str());
  }
  return 0;
}

}  // namespace

void add_sim_command(CLI::App& app, int& exit_code) {
  const auto command = std::make_shared<SimCommand>();
  CLI::App* sim = app.add_subcommand("sim", "Write recordings of simulated robots");
  sim->footer(kHelp);
  sim->add_option("WORLD", command->plan.world, "a world by name, or its file");
  sim->add_option("--out", command->out, "the folder to write");
  sim->add_option("--seed", command->plan.seed, "the same seed gives the same bytes")
      ->capture_default_str();
  sim->add_option("--duration", command->plan.duration_s, "seconds to drive at most, 0: all")
      ->check(CLI::NonNegativeNumber);
  sim->add_option("--view-angle", command->plan.max_view_angle_deg,
                  "leave pixels black that are farther from the optical axis, degrees")
      ->check(CLI::Range(10.0, 180.0))
      ->capture_default_str();
  sim->add_flag("--list", command->list, "list the worlds");
  sim->add_flag("--force", command->force, "replace an older output");
  sim->callback([command, &exit_code] { exit_code = run_sim(*command); });
}

}  // namespace zenith::tools
