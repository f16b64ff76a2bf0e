#include "tools/runner/team.h"

#include <array>

namespace zenith::tools {
namespace {

void share_records(Team& team, int from, const std::vector<int>& to) {
  std::array<LandmarkRecord, 256> records;
  std::size_t count = 0;
  do {
    count = team[from]->slam().publish(records);
    if (count == 0) return;
    for (const int peer : to) {
      team[peer]->slam().receive(slot_of_peer(peer, from), std::span(records).first(count));
    }
  } while (count == records.size());
}

void offer_alignments(Team& team, int from, const std::vector<int>& to) {
  for (const int peer : to) {
    for (const Alignment& a : team[from]->slam().alignments()) {
      if (a.peer != slot_of_peer(from, peer) || a.state != AlignmentState::kMerged) continue;
      team[peer]->slam().offer_alignment(slot_of_peer(peer, from), a.T_own_peer.inverse());
    }
  }
}

}  // namespace

int next_to_step(const Team& team) {
  int best = -1;
  for (int i = 0; i < static_cast<int>(team.size()); ++i) {
    if (!team[i]->has_frame()) continue;
    if (best < 0 || team[i]->stamp() < team[best]->stamp()) best = i;
  }
  return best;
}

void tell_peers(Team& team, int from, const std::vector<int>& to) {
  share_records(team, from, to);
  offer_alignments(team, from, to);
}

}  // namespace zenith::tools
