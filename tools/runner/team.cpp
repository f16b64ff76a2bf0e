#include "tools/runner/team.h"

#include <array>

#include "slam/exchange/record_code.h"

namespace zenith::tools {
namespace {

// Over the wire and back. What cannot be told stays untold.
std::size_t round_as_sent(std::span<LandmarkRecord> records) {
  std::size_t kept = 0;
  for (const LandmarkRecord& record : records) {
    exchange::EncodedRecord encoded;
    if (!exchange::encode_record(record, encoded)) continue;
    ByteReader reader(encoded.bytes());
    LandmarkRecord decoded;
    if (!exchange::decode_record(reader, 0, decoded)) continue;
    decoded.revision = record.revision;
    records[kept++] = decoded;
  }
  return kept;
}

void share_records(Team& team, int from, const std::vector<int>& to, MapSharing sharing) {
  std::array<LandmarkRecord, 256> records;
  std::size_t count = 0;
  do {
    count = team[from]->slam().publish(records);
    if (count == 0) return;
    const auto news = std::span(records).first(count);
    const std::size_t told = sharing == MapSharing::kAsSent ? round_as_sent(news) : count;
    for (const int peer : to) {
      team[peer]->slam().receive(slot_of_peer(peer, from), news.first(told));
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

void tell_peers(Team& team, int from, const std::vector<int>& to, MapSharing sharing) {
  if (sharing == MapSharing::kNone) return;
  share_records(team, from, to, sharing);
  offer_alignments(team, from, to);
}

}  // namespace zenith::tools
