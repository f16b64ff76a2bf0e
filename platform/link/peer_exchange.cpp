#include "platform/link/peer_exchange.h"

#include <algorithm>

namespace zenith {
namespace {

MemoryTable synchroniser_memory() {
  MemoryTable table;
  Arena arena(table);
  exchange::Synchroniser synchroniser;
  synchroniser.layout(arena);
  return table;
}

std::uint16_t key_number(const KeyHint& hint) {
  return exchange::ByteReader(hint).u16();
}

exchange::Sender sender_of(const Session& session) {
  return {session.id.robot, session.id.boot, key_number(session.key)};
}

exchange::Settings with_names(exchange::Settings settings, const SessionSettings& sessions) {
  settings.robot = robot_id(sessions.name.view());
  settings.name.name.clear();
  for (const char c : sessions.name.view()) settings.name.name.push_back(c);
  return settings;
}

}  // namespace

MemoryTable PeerExchange::memory_table() {
  MemoryTable table = synchroniser_memory();
  table.add("exchange: sessions, what is asked and told", sizeof(PeerExchange));
  return table;
}

PeerExchange::PeerExchange(const PeerExchangeSettings& settings)
    : sessions_(settings.sessions), memory_(synchroniser_memory().total()) {
  Arena arena(memory_.span());
  synchroniser_.layout(arena);
  synchroniser_.configure(with_names(settings.synchroniser, settings.sessions));
}

void PeerExchange::receive(Time now, const Endpoint& from, exchange::Bytes datagram,
                           exchange::RecordSink& sink) {
  std::array<std::uint8_t, kMaxPayloadBytes> payload;
  Fresh fresh;
  const bool is_fresh = sessions_.receive(now, from, datagram, payload, fresh);
  if (sessions_.changes() != changes_seen_) reconcile(now);
  // Whoever said goodbye is no peer any more.
  exchange::Sender& sender = joined_[static_cast<std::size_t>(fresh.session)];
  if (!is_fresh || sender == exchange::Sender{}) return;
  if (sender.key != key_number(fresh.key)) {
    sender.key = key_number(fresh.key);
    synchroniser_.change_key(fresh.session, sender.key);
  }
  note_verdict(now, fresh.session,
               synchroniser_.receive(now, fresh.session, fresh.counter, fresh.payload, sink));
}

void PeerExchange::note_verdict(Time now, int session, exchange::Verdict verdict) {
  if (verdict == exchange::Verdict::kMalformed) sessions_.count_rejected(Rejected::kMalformed);
  if (verdict == exchange::Verdict::kQuarantined) sessions_.count_rejected(Rejected::kQuarantined);
  const std::uint64_t quarantines = synchroniser_.counters().quarantines;
  if (quarantines == quarantines_seen_) return;
  quarantines_seen_ = quarantines;
  const Session& peer = *sessions_.session(session);
  if (!synchroniser_.quarantined(now, session)) return;
  sessions_.tell(LinkEventKind::kQuarantined, peer);
  sessions_.set_aside(now, session);
  if (sessions_.changes() != changes_seen_) reconcile(now);
}

// Those who are no longer peers leave before others join: a robot that began anew has both.
void PeerExchange::reconcile(Time now) {
  changes_seen_ = sessions_.changes();
  const auto peer_in = [this](std::size_t slot) {
    const Session* session = sessions_.session(static_cast<int>(slot));
    return session != nullptr && session->is_peer() ? sender_of(*session) : exchange::Sender{};
  };
  const auto is_joined = [&](std::size_t slot) {
    const exchange::Sender peer = peer_in(slot);
    return joined_[slot].robot == peer.robot && joined_[slot].boot == peer.boot;
  };
  for (std::size_t i = 0; i < joined_.size(); ++i) {
    if (joined_[i] == exchange::Sender{} || is_joined(i)) continue;
    synchroniser_.leave(now, static_cast<int>(i));
    joined_[i] = {};
  }
  for (std::size_t i = 0; i < joined_.size(); ++i) {
    if (is_joined(i)) continue;
    joined_[i] = peer_in(i);
    synchroniser_.join(now, static_cast<int>(i), joined_[i]);
  }
}

Dispatch PeerExchange::next(Time now, std::span<std::uint8_t> out) {
  Dispatch dispatch;
  if (sessions_.has_answer() && synchroniser_.spend(now, kAnswerPayloadBytes)) {
    dispatch.size = sessions_.next_answer(dispatch.to, out);
    return dispatch;
  }
  std::array<std::uint8_t, kMaxPayloadBytes> payload;
  while (true) {
    const exchange::Outgoing outgoing = synchroniser_.next(now, payload);
    if (outgoing.size == 0) return dispatch;
    dispatch.to_everybody = outgoing.to == exchange::kEverybody;
    if (!dispatch.to_everybody) {
      const Session* peer = sessions_.session(outgoing.to);
      if (peer == nullptr || !peer->reached) continue;  // as if lost on the way
      dispatch.to = peer->address;
    }
    dispatch.size = sessions_.seal(exchange::Bytes(payload).first(outgoing.size), out);
    return dispatch;
  }
}

Time PeerExchange::next_time(Time now) const {
  const Time next = synchroniser_.next_time(now);
  if (!sessions_.has_answer()) return next;
  return std::min(next, synchroniser_.when_spent(now, kAnswerPayloadBytes));
}

void PeerExchange::forget_silent(Time now) {
  sessions_.forget_silent(now);
  if (sessions_.changes() != changes_seen_) reconcile(now);
}

}  // namespace zenith
