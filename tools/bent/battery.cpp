#include "tools/bent/battery.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <thread>

#include "slam/image/view.h"
#include "tools/bent/bends.h"
#include "tools/report/table.h"
#include "tools/runner/simulated_source.h"
#include "tools/runner/team_run.h"

namespace zenith::tools {
namespace {

// A mount or lens that is told wrongly looks beyond what a right one sees.
constexpr double kMargin_deg = 14.0;
constexpr double kWidest_deg = 150.0;

void run_bend(const BatteryPlan& plan, const Tape& drive, const Bend& bend, BatteryRun& run) {
  Tape tape = drive;
  bend.apply(tape);
  std::vector<std::unique_ptr<Source>> sources;
  sources.push_back(std::make_unique<TapeSource>(tape));
  const auto log = run_team(sources, {plan.parameters, plan.seed, MapSharing::kNone}, {});
  if (log.ok()) {
    run.figures = judge(*log).robots[0];
  } else {
    run.failure = log.error().message;
  }
}

Result<Tape> read_drive(const BatteryPlan& plan, const std::string& world) {
  Parameters wide = plan.parameters;
  if (wide.rectified_fov_deg == kFittedView) wide.rectified_fov_deg = kWidestFitted_deg;
  wide.rectified_fov_deg = std::min(wide.rectified_fov_deg + kMargin_deg, kWidest_deg);
  auto team = simulate_team(world, plan.seed, plan.duration_s, wide);
  if (!team.ok()) return team.error();
  return read_tape(*team->sources[0]);
}

void run_world(const BatteryPlan& plan, const std::string& world, std::vector<BatteryRun>& runs,
               const BatteryProgress& progress) {
  const auto drive = read_drive(plan, world);
  if (!drive.ok()) {
    BatteryRun failed;
    failed.world = world;
    failed.failure = drive.error().message;
    runs.push_back(std::move(failed));
    return;
  }
  const std::vector<Bend> bends = list_bends(drive->duration_s(), plan.quick);
  const std::size_t first = runs.size();
  runs.resize(first + bends.size());
  std::atomic<std::size_t> next = 0;
  std::atomic<std::size_t> done = 0;
  const auto work = [&](bool tell) {
    for (std::size_t i = next++; i < bends.size(); i = next++) {
      BatteryRun& run = runs[first + i];
      run.world = world;
      run.bend = bends[i].name;
      run.unbent = i == 0;
      run_bend(plan, *drive, bends[i], run);
      ++done;
      const auto all = static_cast<double>(bends.size());
      if (tell && progress) progress(static_cast<double>(done) / all);
    }
  };
  std::vector<std::jthread> threads;
  for (int i = 1; i < plan.jobs; ++i) threads.emplace_back(work, false);
  work(true);
}

std::string codes_of(const RobotFigures& figures) {
  std::string text;
  if (!figures.verdict) return text;
  for (const Reason& reason : figures.verdict->reasons) {
    text += (text.empty() ? "" : ", ") + std::string(setup_code_name(reason.code));
  }
  return text;
}

}  // namespace

bool BatteryRun::silent() const {
  return figures.verdict && figures.verdict->state == VerdictState::kGood && figures.ate_m &&
         !(*figures.ate_m <= kSilent_m);
}

bool BatteryRun::false_alarm() const {
  return unbent && figures.verdict && figures.verdict->state != VerdictState::kGood;
}

std::vector<BatteryRun> run_battery(const BatteryPlan& plan, const BatteryProgress& progress) {
  std::vector<BatteryRun> runs;
  for (std::size_t i = 0; i < plan.worlds.size(); ++i) {
    const auto worlds = static_cast<double>(plan.worlds.size());
    run_world(plan, plan.worlds[i], runs, [&](double fraction) {
      if (progress) progress((static_cast<double>(i) + fraction) / worlds);
    });
  }
  return runs;
}

std::string battery_text(const std::vector<BatteryRun>& runs) {
  Table table({"world", "bend", "error m", "wheels m", "verdict", "", "reasons"});
  int silent = 0;
  int false_alarms = 0;
  int failed = 0;
  for (const BatteryRun& run : runs) {
    if (!run.failure.empty()) {
      ++failed;
      table.add({run.world, run.bend, "", "", "failed", "", run.failure});
      continue;
    }
    const RobotFigures& f = run.figures;
    silent += run.silent() ? 1 : 0;
    false_alarms += run.false_alarm() ? 1 : 0;
    const char* remark = run.silent() ? "SILENT" : run.false_alarm() ? "FALSE ALARM" : "";
    table.add({run.world, run.bend, fixed(f.ate_m, 3), fixed(f.odometry_ate_m, 3),
               f.verdict ? std::string(verdict_name(f.verdict->state)) : "", remark, codes_of(f)});
  }
  return table.text(0) + "\n" + std::to_string(runs.size()) + " runs, " + std::to_string(silent) +
         " silent (off by more than 8 cm, and good), " + std::to_string(false_alarms) +
         " false alarms, " + std::to_string(failed) + " failed\n";
}

}  // namespace zenith::tools
