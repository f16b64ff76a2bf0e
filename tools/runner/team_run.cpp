#include "tools/runner/team_run.h"

#include <cmath>
#include <string>
#include <vector>

#include "tools/runner/joint_run.h"
#include "tools/runner/team.h"

namespace zenith::tools {
namespace {

// Where a landmark stands depends on how high the camera is above the floor.
Status check_cameras(std::span<const std::unique_ptr<Source>> sources) {
  const RobotConfig& first = sources[0]->config();
  for (const auto& source : sources) {
    if (std::abs(source->config().mount.z_m - first.mount.z_m) < 0.002) continue;
    return Error{"a joint run needs all cameras at one height: " + source->name() +
                 "'s is not at " + sources[0]->name() + "'s"};
  }
  return {};
}

Status check_team(std::span<const std::unique_ptr<Source>> sources) {
  if (sources.empty()) return Error{"a run needs at least one robot"};
  if (sources.size() > std::size_t{kMaxObservers}) {
    return Error{"a team has at most " + std::to_string(kMaxObservers) + " robots, found " +
                 std::to_string(sources.size())};
  }
  return {};
}

std::vector<int> all_but(const Team& team, int robot) {
  std::vector<int> others;
  for (int i = 0; i < static_cast<int>(team.size()); ++i) {
    if (i != robot) others.push_back(i);
  }
  return others;
}

// Every robot its own filter. Returns the first failure of a source.
Status run_apart(Team& team, const RunOptions& options, int total, const RunProgress& progress) {
  int done = 0;
  for (int i = next_to_step(team); i >= 0; i = next_to_step(team)) {
    team[i]->step();
    tell_peers(team, i, all_but(team, i), options.sharing);
    if (options.after_step) options.after_step(static_cast<std::size_t>(i), *team[i]);
    if (const auto more = team[i]->advance(); !more.ok()) return more.error();
    if (progress) progress(++done, total);
  }
  return {};
}

}  // namespace

Result<TeamLog> run_team(std::span<const std::unique_ptr<Source>> sources,
                         const RunOptions& options, const RunProgress& progress) {
  if (const Status checked = check_team(sources); !checked) return checked.error();
  const int size = static_cast<int>(sources.size());
  Team team;
  int total = 0;
  for (int i = 0; i < size; ++i) {
    const std::uint64_t seed = options.seed * 1000 + static_cast<std::uint64_t>(i);
    team.push_back(std::make_unique<Member>(*sources[i], options.parameters, seed, i, size));
    total += sources[i]->frame_count();
    if (const auto more = team.back()->advance(); !more.ok()) return more.error();
  }
  TeamLog log;
  if (options.joint) {
    if (const Status checked = check_cameras(sources); !checked) return checked.error();
    auto joint = run_joint(team, options, total, progress);
    if (!joint.ok()) return joint.error();
    log.joint = std::move(*joint);
  } else {
    const Status ran = run_apart(team, options, total, progress);
    if (!ran) return ran.error();
  }
  for (auto& member : team) log.robots.push_back(member->finish());
  return log;
}

}  // namespace zenith::tools
