// zenith eval: simulation, SLAM and judgement in memory, over many seeds.

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "platform/linux/printable_output.h"
#include "tools/atomic_output.h"
#include "tools/bent/battery.h"
#include "tools/commands.h"
#include "tools/evaluation.h"
#include "tools/overrides.h"
#include "tools/progress.h"
#include "tools/relocalisation.h"
#include "tools/replay_judgement.h"
#include "tools/report/figures_text.h"
#include "tools/simulate.h"

namespace zenith::tools {
namespace {

constexpr const char* kHelp =
    R"(Simulates, maps and judges, all in memory, once for every seed; prints the figures of each
run and a table of median / worst for each world. With --replay it judges the output of
`zenith replay` against the ground truth of the recordings instead. With --bent the first robot of each
world drives once, its recording is made wrong in every way that set-ups and rides go wrong, and a table
tells for each the error, the wheels' error and the verdict (docs/verdict.md). The exit code is then 1
when a run is off by more than 8 cm and called good, or a right one is not.

Examples:
  zenith eval corridor-rooms
  zenith eval corridor-rooms loop --seeds 10 --jobs 2 --json figures.json
  zenith eval corridor-rooms --seeds 5 --set particles=800 --set pixel_sigma_px=1
  zenith eval --replay out rec/a rec/b
  zenith eval --bent corridor-rooms loop --jobs 2

What the columns mean:
  ATE         root mean square error of the trajectory after the best rigid fit
  odometry    the same for the wheels alone; ratio: the first by the second
  return      error of the position when the robot comes back to its start, before the start is
              seen again and after it was passed, in the robot's start frame
  jumps       frames whose increment is off by more than 5 cm or 1 degree; wrong: the error in the
              start frame is larger after it, or it is undone within 20 frames
  pair a < b  what robot a made of robot b's map; `driven` is a's way since it first came
              within 1.5 m of a place where b has been, until a merged the maps
  WRONG       a transform that is off by more than 0.5 m or 5 degrees
  double      landmarks of the two robots within 5 cm that were not made one)";

struct EvalOptions {
  bool relocalise = false;
  double relocalise_way_m = RelocalisationPlan{}.most_way_m;
  EvaluationPlan plan;
  std::vector<std::string> subjects;  // worlds, or recordings with --replay
  std::vector<std::string> assignments;
  std::string json_path;
  std::string replay_output;
  bool bent = false;
  bool quick = false;
  bool alone = false;
  bool exact_maps = false;
};

void print_run(const EvaluationRun& run) {
  if (isatty(STDERR_FILENO) == 1) write_to_terminal("\r\033[K");
  std::printf("%s, seed %llu\n", run.world.c_str(), static_cast<unsigned long long>(run.seed));
  if (run.failure.empty()) {
    std::printf("%s\n", figures_text(run.figures).c_str());
  } else {
    std::printf("  failed: %s\n\n", run.failure.c_str());
  }
  std::fflush(stdout);
}

void print_summaries(const EvaluationPlan& plan, const std::vector<EvaluationRun>& runs) {
  for (const std::string& world : plan.worlds) {
    std::vector<TeamFigures> figures;
    int failed = 0;
    for (const EvaluationRun& run : runs) {
      if (run.world != world) continue;
      if (run.failure.empty()) {
        figures.push_back(run.figures);
      } else {
        ++failed;
      }
    }
    std::printf("%s, %d runs", world.c_str(), plan.seeds);
    if (failed > 0) std::printf(", %d of them FAILED", failed);
    std::printf("\n%s\n", summary_text(figures).c_str());
  }
}

Status write_json(const std::string& path, const std::vector<EvaluationRun>& runs) {
  nlohmann::json json = nlohmann::json::array();
  for (const EvaluationRun& run : runs) {
    nlohmann::json one =
        run.failure.empty() ? figures_json(run.figures) : nlohmann::json{{"failure", run.failure}};
    one["world"] = run.world;
    one["seed"] = run.seed;
    json.push_back(std::move(one));
  }
  return write_file(path, json.dump(2) + "\n");
}

EvaluationRun judge_replay(const EvalOptions& options) {
  EvaluationRun run;
  run.world = options.replay_output;
  auto figures =
      judge_output(options.replay_output, {options.subjects.begin(), options.subjects.end()});
  if (figures.ok()) {
    run.figures = std::move(*figures);
  } else {
    run.failure = figures.error().message;
  }
  return run;
}

int run_replay_judgement(const EvalOptions& options) {
  const EvaluationRun run = judge_replay(options);
  if (!run.failure.empty()) return fail({run.failure});
  std::printf("%s\n%s", options.replay_output.c_str(), figures_text(run.figures).c_str());
  if (options.json_path.empty()) return 0;
  const Status written = write_json(options.json_path, {run});
  return written ? 0 : fail(written.error());
}

int run_relocalisation(const EvalOptions& options, const Parameters& parameters) {
  for (const std::string& world : options.subjects) {
    for (int i = 0; i < options.plan.seeds; ++i) {
      RelocalisationPlan plan;
      plan.world = world;
      plan.seed = options.plan.first_seed + static_cast<std::uint64_t>(i);
      plan.parameters = parameters;
      plan.most_way_m = options.relocalise_way_m;
      Progress progress("mapping");
      const auto run = relocalise(plan, [&](double fraction) { progress.update(fraction); });
      if (!run.ok()) return fail(run.error());
      std::printf("%s, seed %llu\n%s", world.c_str(), static_cast<unsigned long long>(plan.seed),
                  relocalisation_text(*run).c_str());
    }
  }
  return 0;
}

int run_bent(const EvalOptions& options, const Parameters& parameters) {
  BatteryPlan plan;
  plan.worlds = options.subjects;
  plan.seed = options.plan.first_seed;
  plan.duration_s = options.plan.duration_s;
  plan.jobs = options.plan.jobs;
  plan.quick = options.quick;
  plan.parameters = parameters;
  if (const Status known = check_worlds(plan.worlds); !known) return fail(known.error());
  const auto runs = [&] {
    Progress progress("mapping");
    return run_battery(plan, [&](double fraction) { progress.update(fraction); });
  }();
  std::printf("%s", battery_text(runs).c_str());
  const bool bad = std::any_of(runs.begin(), runs.end(), [](const BatteryRun& run) {
    return !run.failure.empty() || run.silent() || run.false_alarm();
  });
  return bad ? 1 : 0;
}

int run_eval(EvalOptions& options) {
  if (!options.replay_output.empty()) return run_replay_judgement(options);
  const auto parameters = apply_overrides({}, options.assignments);
  if (!parameters.ok()) return fail(parameters.error());
  if (options.bent) return run_bent(options, *parameters);
  if (options.relocalise) return run_relocalisation(options, *parameters);
  EvaluationPlan& plan = options.plan;
  plan.parameters = *parameters;
  plan.worlds = options.subjects;
  if (options.alone) plan.sharing = MapSharing::kNone;
  if (options.exact_maps) plan.sharing = MapSharing::kExact;
  if (const Status known = check_worlds(plan.worlds); !known) return fail(known.error());
  std::vector<EvaluationRun> runs;
  {
    Progress progress("evaluating");
    runs = evaluate(plan, {[&](double fraction) { progress.update(fraction); }, print_run});
  }
  if (plan.seeds > 1) print_summaries(plan, runs);
  if (!options.json_path.empty()) {
    if (const Status written = write_json(options.json_path, runs); !written) {
      return fail(written.error());
    }
  }
  for (const EvaluationRun& run : runs) {
    if (!run.failure.empty()) return 1;
  }
  return 0;
}

}  // namespace

void add_eval_command(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<EvalOptions>();
  CLI::App* eval = app.add_subcommand("eval", "Simulate, map and judge over many seeds");
  eval->footer(kHelp);
  eval->add_option("WORLD", options->subjects, "worlds by name or file (`zenith sim --list`)")
      ->required();
  eval->add_option("--seeds", options->plan.seeds, "how many seeds")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  eval->add_option("--first-seed", options->plan.first_seed, "the first of them")
      ->capture_default_str();
  eval->add_option("--duration", options->plan.duration_s, "seconds to drive at most, 0: all")
      ->check(CLI::NonNegativeNumber);
  eval->add_option("--jobs", options->plan.jobs, "runs side by side")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  CLI::Option* alone =
      eval->add_flag("--alone", options->alone, "robots do not tell each other anything");
  eval->add_flag("--exact-maps", options->exact_maps,
                 "maps reach the others unrounded, to see what the wire's rounding costs")
      ->excludes(alone);
  eval->add_flag("--relocalise", options->relocalise,
                 "the first robot maps alone; each other one must find itself in its stored map");
  eval->add_option("--way", options->relocalise_way_m,
                   "with --relocalise: metres to drive at most until it is found")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI::Option* bent = eval->add_flag(
      "--bent", options->bent,
      "make the first robot's recording wrong in every way, and print what was told");
  eval->add_flag("--quick", options->quick, "with --bent: one size of the most telling ways alone")
      ->needs(bent);
  eval->add_flag("--joint", options->plan.joint, "aligned robots go on in one filter")
      ->excludes(alone);
  add_set_option(*eval, options->assignments);
  eval->add_option("--replay", options->replay_output,
                   "judge this output of `zenith replay`; WORLD are then its recordings");
  eval->add_option("--json", options->json_path, "write all figures to this file");
  eval->callback([options, &exit_code] { exit_code = run_eval(*options); });
}

}  // namespace zenith::tools
