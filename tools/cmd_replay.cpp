// zenith replay: maps from recordings.

#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tools/atomic_output.h"
#include "tools/commands.h"
#include "tools/overrides.h"
#include "tools/progress.h"
#include "tools/replay.h"
#include "tools/report/figures_text.h"

namespace zenith::tools {
namespace {

// The maps were written, but the set-up of a robot contradicts itself.
constexpr int kWrongSetup = 3;

constexpr const char* kHelp =
    R"(Runs the recordings through SLAM, in the order of their stamps, each as one robot named after
its folder; the robots tell each other their landmarks at once. The same recordings, seed and
parameters give the same output, bit for bit, but for times of computation.

OUT holds summary.json, map.png, confidence.png and for each robot trajectory.tum, landmarks.csv,
alignments.csv and confidence.csv. It appears when everything is written. `zenith view OUT` plays
it in a browser.

With --joint a robot that merges with another one takes it into its own filter: one map, updated
with what all of them see at the same time (the paper's Eq. 2-3). Trajectories stay in each robot's
own start frame, alignments.csv then holds the alignment at which the filters were joined, and
landmarks.csv of each of them the one map, in its own start frame. All cameras must be at the same
height.

Recordings of `zenith record` say where their clocks lay against the wall clock (clock.csv): several
are put on that one time first, whatever the computers' uptimes. What they have in common is printed;
when they have nothing in common it says by how much. Recordings without clock.csv are taken as
stamped by one clock; --align start and --offset say otherwise. Where wheels and frames of one recording
do not fit, the offset at which their turns do is looked for and told: --wheels-late applies it.

For each robot a verdict is printed, and written to summary.json, on whether its set-up can be right:
camera, wheels and their clocks are compared with each other (docs/verdict.md). The exit code is 0
when all are good or doubtful, 3 when one is wrong: the maps are written but not to be used.

Examples:
  zenith replay rec/a rec/b --out out
  zenith replay rec/* --out out --force --set particles=400
  zenith replay rec/a rec/b --out out --joint
  zenith replay old/a old/b --out out --offset b=12.5
  zenith replay rec/a --out out --skip-damaged)";

struct ReplayCommand {
  ReplayPlan plan;
  std::vector<std::string> assignments;
  std::string align = "clocks";
  std::vector<std::string> offsets;
  std::vector<std::string> wheels_late;
  std::string out;
  bool force = false;
};

int run_replay(ReplayCommand& command) {
  const auto parameters = apply_overrides({}, command.assignments);
  if (!parameters.ok()) return fail(parameters.error());
  command.plan.parameters = *parameters;
  AlignOptions& align = command.plan.align;
  align.by = command.align == "start"      ? AlignBy::kStart
             : command.align == "recorded" ? AlignBy::kRecorded
                                           : AlignBy::kClocks;
  const auto parse = [](const char* option, const std::vector<std::string>& texts,
                        std::map<std::string, double>& values) -> Status {
    for (const std::string& text : texts) {
      const auto stated = parse_stated_offset(text);
      if (!stated.ok()) return Error{option + (": " + stated.error().message)};
      values[stated->first] = stated->second;
    }
    return {};
  };
  Status parsed = parse("--offset", command.offsets, align.stated_s);
  if (parsed) parsed = parse("--wheels-late", command.wheels_late, command.plan.wheels_late_s);
  if (!parsed) return fail(parsed.error()) + 1;
  // `rec/*` of a simulation's output holds its description too.
  std::erase_if(command.plan.recordings,
                [](const auto& path) { return path.filename() == "simulation.json"; });
  if (command.plan.recordings.empty()) return fail({"replay needs recordings"}) + 1;
  auto output = AtomicFolder::create(command.out, command.force, "summary.json");
  if (!output.ok()) return fail(output.error());
  const auto result = [&] {
    Progress progress("mapping");
    return replay(command.plan, output->path(),
                  [&](double fraction) { progress.update(fraction); });
  }();
  if (!result.ok()) return fail(result.error());
  if (const Status placed = output->commit(); !placed) return fail(placed.error());
  warn(result->warnings);
  for (const std::string& note : result->notes) std::printf("%s\n", note.c_str());
  std::string views;
  for (const std::string& view : result->views) views += "  " + view + "\n";
  std::printf("%s%s%s\nmemory: %.1f MiB for each robot, taken at the start\n%s\n",
              figures_text(result->figures).c_str(), verdicts_text(result->figures).c_str(),
              views.c_str(), static_cast<double>(result->memory_bytes) / (1024.0 * 1024.0),
              command.out.c_str());
  return is_wrong(result->figures) ? kWrongSetup : 0;
}

}  // namespace

void add_replay_command(CLI::App& app, int& exit_code) {
  const auto command = std::make_shared<ReplayCommand>();
  CLI::App* replay = app.add_subcommand("replay", "Map recordings, together");
  replay->footer(kHelp);
  replay->add_option("RECORDING", command->plan.recordings, "recordings' folders, one a robot")
      ->required();
  replay->add_option("--out", command->out, "the folder to write")->required();
  replay
      ->add_option("--align", command->align,
                   "clocks: by clock.csv of the recordings; start: all begin together; recorded: "
                   "stamps as they are")
      ->check(CLI::IsMember({"clocks", "start", "recorded"}))
      ->capture_default_str();
  replay
      ->add_option("--offset", command->offsets,
                   "ROBOT=SECONDS: added to the stamps of this robot's recording, beside --align")
      ->allow_extra_args(false);
  replay
      ->add_option("--wheels-late", command->wheels_late,
                   "ROBOT=SECONDS: taken from the stamps of its wheels")
      ->allow_extra_args(false);
  replay->add_option("--seed", command->plan.seed, "seed of the particles")->capture_default_str();
  replay->add_flag("--joint", command->plan.joint,
                   "robots that have merged go on in one filter with one map");
  add_set_option(*replay, command->assignments);
  replay
      ->add_option("--max-gap", command->plan.reading.max_odometry_gap_s,
                   "tell of holes in the odometry that are longer, seconds")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  replay->add_flag("--skip-damaged", command->plan.reading.skip_damaged,
                   "leave out missing and damaged frames instead of stopping");
  replay->add_flag("--force", command->force, "replace an older output");
  replay->callback([command, &exit_code] { exit_code = run_replay(*command); });
}

}  // namespace zenith::tools
