#include "tools/replay.h"

#include <memory>
#include <set>

#include "tools/report/confidence_picture.h"
#include "tools/report/files.h"
#include "tools/report/map_picture.h"
#include "tools/runner/team_run.h"
#include "tools/view/timeline.h"
#include "tools/view/timeline_writer.h"

namespace zenith::tools {
namespace {

// All recordings, or what is wrong with any of them.
Result<std::vector<std::unique_ptr<Source>>> open_all(const ReplayPlan& plan) {
  std::vector<std::unique_ptr<Source>> sources;
  std::set<std::string> names;
  std::string problems;
  for (const auto& folder : plan.recordings) {
    auto recording = Recording::open(folder, plan.reading);
    std::string problem;
    if (!recording.ok()) {
      problem = recording.error().message;
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
  if (!problems.empty()) return Error{problems};
  return sources;
}

}  // namespace

Result<ReplayResult> replay(const ReplayPlan& plan, const std::filesystem::path& folder,
                            const std::function<void(double)>& progress) {
  auto sources = open_all(plan);
  if (!sources.ok()) return sources.error();
  const auto report = [&](int done, int total) {
    if (progress) progress(static_cast<double>(done) / total);
  };
  std::vector<std::string> names;
  for (const auto& source : *sources) names.push_back(source->name());
  TimelineWriter timeline(folder / kTimelineFile, names);
  const auto note = [&](std::size_t robot, Member& member) { timeline.note(robot, member); };
  const auto log = run_team(
      *sources, {plan.parameters, plan.seed, MapSharing::kAsSent, plan.joint, note}, report);
  if (!log.ok()) return log.error();
  if (const Status written = timeline.finish(); !written) return written.error();
  ReplayResult result;
  result.figures = judge(*log);
  result.memory_bytes = Slam::memory_needed(plan.parameters);
  RunDescription run;
  run.seed = plan.seed;
  run.parameters = plan.parameters;
  for (const auto& source : *sources) {
    const auto warnings = static_cast<const Recording&>(*source).warnings();
    result.warnings.insert(result.warnings.end(), warnings.begin(), warnings.end());
    run.warnings.push_back(warnings);
  }
  Status written = write_files(folder, *log, result.figures, run);
  if (written) written = draw_map(folder / "map.png", *log, result.figures);
  if (written && log->robots.size() > 1) {
    written =
        draw_confidence(folder / "confidence.png", *log, plan.parameters.confidence_threshold);
  }
  if (!written) return written.error();
  return result;
}

}  // namespace zenith::tools
