#include "tools/relocalisation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "platform/storage/map_file.h"
#include "platform/storage/own_map.h"
#include "tools/runner/member.h"
#include "tools/runner/simulated_source.h"

namespace zenith::tools {
namespace {

constexpr int kPast = 0;  // the slot of the stored map

struct Mapped {
  storage::StoredMap map;
  Pose2 T_world_map;  // where its frame truly is
};

// Steps a robot's next frame. The way that it truly drove since the last one is added to `way_m`.
Result<bool> step(Member& robot, Pose2& last, double& way_m) {
  if (!robot.has_frame()) return false;
  robot.step();
  const Pose2 truth = *robot.last_frame().truth;
  way_m += (truth.position() - last.position()).norm();
  last = truth;
  const auto more = robot.advance();
  if (!more.ok()) return more.error();
  return true;
}

void take_news(Slam& slam, storage::OwnMap& map) {
  std::array<LandmarkRecord, 256> records;
  std::size_t count = 0;
  do {
    count = slam.publish(records);
    for (std::size_t i = 0; i < count; ++i) map.note(records[i]);
  } while (count == records.size());
}

Result<Mapped> make_map(Source& source, const RelocalisationPlan& plan, RelocalisationRun& run,
                        const RelocalisationProgress& progress) {
  Member robot(source, plan.parameters, plan.seed * 1000, 0, 1);
  if (const auto more = robot.advance(); !more.ok()) return more.error();
  Mapped mapped;
  storage::OwnMap own;
  Pose2 truth;
  double unused_m = 0.0;
  if (const auto first = step(robot, truth, unused_m); !first.ok()) return first.error();
  mapped.T_world_map = truth * robot.last_frame().T_start_robot.inverse();
  for (int done = 1;; ++done) {
    const auto more = step(robot, truth, run.mapped_way_m);
    if (!more.ok()) return more.error();
    if (!*more) break;
    take_news(robot.slam(), own);
    if (progress && done % 16 == 0) progress(static_cast<double>(done) / source.frame_count());
  }
  const Pose2 last = mapped.T_world_map * robot.last_frame().T_start_robot;
  run.map_error_m = (last.position() - truth.position()).norm();
  mapped.map.landmarks = own.landmarks();
  return mapped;
}

Result<RelocalisationStart> start_in(const storage::StoredMap& map, const Pose2& T_world_map,
                                     Source& source, const RelocalisationPlan& plan, int index) {
  RelocalisationStart start;
  start.robot = source.name();
  Member robot(source, plan.parameters, plan.seed * 1000 + static_cast<std::uint64_t>(index), 0, 2);
  robot.slam().remember(kPast, map.landmarks);
  if (const auto more = robot.advance(); !more.ok()) return more.error();
  Pose2 truth;
  double unused_m = 0.0;
  if (const auto first = step(robot, truth, unused_m); !first.ok()) return first.error();
  while (start.way_m < plan.most_way_m) {
    const auto more = step(robot, truth, start.way_m);
    if (!more.ok()) return more.error();
    if (!*more) break;
    std::array<LandmarkRecord, 256> records;
    robot.slam().publish(records);
    for (const Alignment& a : robot.slam().alignments()) {
      if (a.peer != kPast || a.state != AlignmentState::kMerged) continue;
      const Pose2 T_map_robot = a.T_own_peer.inverse() * robot.last_frame().T_start_robot;
      const Pose2 error = (T_world_map.inverse() * truth).inverse() * T_map_robot;
      start.found = true;
      start.error_m = error.position().norm();
      start.error_rad = std::abs(wrap_angle(error.theta_rad));
      start.right = start.error_m <= plan.right_m && start.error_rad <= plan.right_rad;
      return start;
    }
  }
  return start;
}

}  // namespace

Result<RelocalisationRun> relocalise(const RelocalisationPlan& plan,
                                     const RelocalisationProgress& progress) {
  auto team = simulate_team(plan.world, plan.seed, 0.0, plan.parameters);
  if (!team.ok()) return team.error();
  if (team->sources.size() < 2) {
    return Error{plan.world +
                 ": expected a robot that maps and others that find themselves in its "
                 "map, found one robot"};
  }
  RelocalisationRun run;
  auto mapped = make_map(*team->sources[0], plan, run, progress);
  if (!mapped.ok()) return mapped.error();
  const auto bytes = storage::encode_map(mapped->map);
  const storage::DecodedMap decoded = storage::decode_map(bytes);
  if (decoded.fault != storage::MapFault::kNone) return Error{decoded.reason};
  run.landmarks = decoded.map.landmarks.size();
  run.map_bytes = bytes.size();
  for (std::size_t i = 1; i < team->sources.size(); ++i) {
    auto start =
        start_in(decoded.map, mapped->T_world_map, *team->sources[i], plan, static_cast<int>(i));
    if (!start.ok()) return start.error();
    run.starts.push_back(std::move(*start));
  }
  return run;
}

std::string relocalisation_text(const RelocalisationRun& run) {
  char line[200];
  std::string text;
  int right = 0;
  int wrong = 0;
  double longest_m = 0.0;
  for (const RelocalisationStart& s : run.starts) {
    const char* verdict = !s.found ? "not found" : s.right ? "right" : "WRONG";
    std::snprintf(line, sizeof line, "%-8s %-9s after %4.2f m, off by %.3f m, %.2f deg\n",
                  s.robot.c_str(), verdict, s.way_m, s.error_m,
                  s.error_rad * 180.0 / std::numbers::pi);
    text += line;
    right += s.right ? 1 : 0;
    wrong += s.found && !s.right ? 1 : 0;
    if (s.right) longest_m = std::max(longest_m, s.way_m);
  }
  std::snprintf(
      line, sizeof line,
      "stored map: %zu landmarks, %zu bytes, of a drive of %.0f m that ended %.2f m off\n",
      run.landmarks, run.map_bytes, run.mapped_way_m, run.map_error_m);
  text += line;
  std::snprintf(line, sizeof line,
                "found itself: right %d of %zu, wrong %d; the latest of them after %.2f m\n", right,
                run.starts.size(), wrong, longest_m);
  return text + line;
}

}  // namespace zenith::tools
