#include "tools/replay.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <set>

#include "platform/config/lens_settings.h"
#include "platform/config/robot_settings.h"
#include "tools/clocks/shifted_source.h"
#include "tools/clocks/wheel_offset.h"
#include "tools/report/confidence_picture.h"
#include "tools/report/files.h"
#include "tools/report/map_picture.h"
#include "tools/runner/team_run.h"
#include "tools/view/timeline.h"
#include "tools/view/timeline_writer.h"

namespace zenith::tools {
namespace {

Result<std::unique_ptr<Recording>> open_one(const ReplayPlan& plan,
                                            const std::filesystem::path& folder) {
  ReadOptions reading = plan.reading;
  const auto late = plan.wheels_late_s.find(Recording::name_of(folder));
  if (late != plan.wheels_late_s.end()) {
    reading.wheels_late = Duration::from_seconds(late->second);
  }
  return Recording::open(folder, reading);
}

// Of a recording that could not be opened: whether its wheels and frames fit on one clock.
std::string other_clock(const std::filesystem::path& folder, const ReplayPlan& plan) {
  const auto offset = measure_wheel_offset(folder, plan.reading, plan.parameters);
  if (!offset.ok() || !offset->sure) return {};
  return "\n" + wheel_offset_text(Recording::name_of(folder), *offset);
}

// Where camera and wheels do not fit, whether another offset of their stamps mends it.
void find_offsets(const ReplayPlan& plan, ReplayResult& result) {
  constexpr double kLeastGain = 2.0;
  constexpr double kLeast_s = 0.25;  // below, the verdict measures it
  for (std::size_t i = 0; i < plan.recordings.size(); ++i) {
    const auto& verdict = result.figures.robots[i].verdict;
    const bool odd = verdict && (verdict->state == VerdictState::kWrong ||
                                 gives(*verdict, SetupCode::kWheelsSlipped) ||
                                 gives(*verdict, SetupCode::kRobotPushed));
    if (!odd) continue;
    const auto recording = open_one(plan, plan.recordings[i]);
    if (!recording.ok()) continue;
    const auto offset = measure_wheel_offset(**recording, plan.parameters);
    if (!offset.ok() || !offset->sure || offset->gain < kLeastGain) continue;
    if (std::abs(offset->late_s) < kLeast_s) continue;
    WheelOffset whole = *offset;
    whole.late_s += (*recording)->wheels_moved().seconds();
    result.warnings.push_back(wheel_offset_text((*recording)->name(), whole));
  }
}

// All recordings, or what is wrong with any of them.
Result<std::vector<std::unique_ptr<Recording>>> open_all(const ReplayPlan& plan) {
  std::vector<std::unique_ptr<Recording>> sources;
  std::set<std::string> names;
  std::string problems;
  for (const auto& folder : plan.recordings) {
    auto recording = open_one(plan, folder);
    std::string problem;
    if (!recording.ok()) {
      problem = recording.error().message + other_clock(folder, plan);
    } else if (!names.insert((*recording)->name()).second) {
      problem = folder.string() + ": two recordings are named '" + (*recording)->name() +
                "'; robots are named after their folders, so rename one";
    }
    if (problem.empty()) {
      sources.push_back(std::move(*recording));
    } else {
      problems += (problems.empty() ? "" : "\n") + problem;
    }
  }
  for (const auto& [name, late_s] : plan.wheels_late_s) {
    if (!names.contains(name) && problems.empty()) {
      problems = "--wheels-late " + name + ": expected the name of one of the recordings";
    }
  }
  if (!problems.empty()) return Error{problems};
  return sources;
}

Result<Alignment> align_clocks(const std::vector<std::unique_ptr<Recording>>& recordings,
                               const ReplayPlan& plan) {
  std::vector<RecordedSpan> spans;
  for (const auto& r : recordings) {
    spans.push_back({r->name(), r->first_stamp(), r->last_stamp(), r->clock()});
  }
  auto alignment = align(spans, plan.align);
  if (!alignment.ok() || !plan.joint || !alignment->disjoint) return alignment;
  std::string message = "--joint needs recordings that were made together";
  for (const std::string& warning : alignment->warnings) message += "\n" + warning;
  return Error{message};
}

// What robots exchange are patches of the rectified image: views of other angles have them at
// another scale. Empty when they are much the same.
std::string different_scales(const std::vector<View>& views) {
  constexpr double kSame = 1.15;
  double least = 1e9;
  double most = 0.0;
  for (const View& view : views) {
    least = std::min(least, view.fov_deg);
    most = std::max(most, view.fov_deg);
  }
  const auto half = [](double deg) { return std::tan(deg * std::numbers::pi / 360.0); };
  if (half(most) < kSame * half(least)) return {};
  char text[200];
  std::snprintf(text, sizeof text,
                "the robots' views are %.4g to %.4g degrees wide, and their landmarks look "
                "different at different scales: to let them merge, give all the same, --set "
                "rectified_fov_deg=%.4g",
                least, most, least);
  return text;
}

}  // namespace

Result<ReplayResult> replay(const ReplayPlan& plan, const std::filesystem::path& folder,
                            const std::function<void(double)>& progress) {
  auto opened = open_all(plan);
  if (!opened.ok()) return opened.error();
  const auto alignment = align_clocks(*opened, plan);
  if (!alignment.ok()) return alignment.error();
  std::vector<const Recording*> recordings;
  std::vector<std::unique_ptr<Source>> sources;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < opened->size(); ++i) {
    recordings.push_back((*opened)[i].get());
    names.push_back(recordings.back()->name());
    sources.push_back(
        std::make_unique<ShiftedSource>(std::move((*opened)[i]), alignment->shifts[i]));
  }
  const auto report = [&](int done, int total) {
    if (progress) progress(static_cast<double>(done) / total);
  };
  TimelineWriter timeline(folder / kTimelineFile, names);
  const auto note = [&](std::size_t robot, Member& member) { timeline.note(robot, member); };
  const auto log = run_team(
      sources, {plan.parameters, plan.seed, MapSharing::kAsSent, plan.joint, note}, report);
  if (!log.ok()) return log.error();
  if (const Status written = timeline.finish(); !written) return written.error();
  ReplayResult result;
  result.figures = judge(*log);
  result.memory_bytes = Slam::memory_needed(plan.parameters);
  RunDescription run;
  run.seed = plan.seed;
  run.parameters = plan.parameters;
  result.notes = alignment->notes;
  result.warnings = alignment->warnings;
  run.alignment = *alignment;
  for (const Recording* recording : recordings) {
    const RobotConfig& robot = recording->config();
    result.views.push_back("view of " + recording->name() + ": " +
                           view_text(plan.parameters, robot));
    if (const std::string about_lens = lens_note(robot.lens); !about_lens.empty()) {
      result.warnings.push_back(recording->name() + ": " + about_lens);
    }
    run.views.push_back(view_of(plan.parameters, robot));
    const auto warnings = recording->warnings();
    result.warnings.insert(result.warnings.end(), warnings.begin(), warnings.end());
    run.warnings.push_back(warnings);
  }
  const std::string scales = different_scales(run.views);
  if (run.views.size() > 1 && !scales.empty()) result.warnings.push_back(scales);
  Status written = write_files(folder, *log, result.figures, run);
  if (written) written = draw_map(folder / "map.png", *log, result.figures);
  if (written && log->robots.size() > 1) {
    written =
        draw_confidence(folder / "confidence.png", *log, plan.parameters.confidence_threshold);
  }
  if (!written) return written.error();
  find_offsets(plan, result);
  return result;
}

}  // namespace zenith::tools
