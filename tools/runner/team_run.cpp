#include "tools/runner/team_run.h"

#include <array>
#include <string>
#include <vector>

#include "tools/runner/member.h"

namespace zenith::tools {
namespace {

using Team = std::vector<std::unique_ptr<Member>>;

// The robot whose next frame is the oldest, or -1 when all are at their end.
int next_to_step(const Team& team) {
  int best = -1;
  for (int i = 0; i < static_cast<int>(team.size()); ++i) {
    if (!team[i]->has_frame()) continue;
    if (best < 0 || team[i]->stamp() < team[best]->stamp()) best = i;
  }
  return best;
}

void share_records(Team& team, int from) {
  std::array<LandmarkRecord, 256> records;
  std::size_t count = 0;
  do {
    count = team[from]->slam().publish(records);
    for (int to = 0; to < static_cast<int>(team.size()) && count > 0; ++to) {
      if (to == from) continue;
      team[to]->slam().receive(slot_of_peer(to, from), std::span(records).first(count));
    }
  } while (count == records.size());
}

// Whoever has merged tells the peer; the peer tests it against its own map.
void offer_alignments(Team& team, int from) {
  for (int to = 0; to < static_cast<int>(team.size()); ++to) {
    if (to == from) continue;
    for (const Alignment& a : team[from]->slam().alignments()) {
      if (a.peer != slot_of_peer(from, to) || a.state != AlignmentState::kMerged) continue;
      team[to]->slam().offer_alignment(slot_of_peer(to, from), a.T_own_peer.inverse());
    }
  }
}

Status check_team(std::span<const std::unique_ptr<Source>> sources) {
  if (sources.empty()) return Error{"a run needs at least one robot"};
  if (sources.size() > std::size_t{kMaxPeers} + 1) {
    return Error{"a team has at most " + std::to_string(kMaxPeers + 1) + " robots, found " +
                 std::to_string(sources.size())};
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
  int done = 0;
  for (int i = next_to_step(team); i >= 0; i = next_to_step(team)) {
    team[i]->step();
    if (options.share_maps) {
      share_records(team, i);
      offer_alignments(team, i);
    }
    if (const auto more = team[i]->advance(); !more.ok()) return more.error();
    if (progress) progress(++done, total);
  }
  TeamLog log;
  for (auto& member : team) log.robots.push_back(member->finish());
  return log;
}

}  // namespace zenith::tools
