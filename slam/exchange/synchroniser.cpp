#include "slam/exchange/synchroniser.h"

#include <algorithm>
#include <new>

#include "platform/base/ensure.h"
#include "slam/exchange/synchroniser_state.h"

namespace zenith::exchange {

void Synchroniser::layout(Arena& arena) {
  arena.part("exchange: sessions, what is asked and told");
  const std::span<State> state = arena.take<State>(1);
  OwnRecords own;
  ReplicaStore replicas;
  arena.part("exchange: own records");
  own.layout(arena);
  arena.part("exchange: which of the peers' records are here");
  replicas.layout(arena);
  if (state.empty()) return;
  state_ = state.data();
  state_->own = own;
  state_->replicas = replicas;
}

void Synchroniser::configure(const Settings& settings) {
  const OwnRecords own = state_->own;
  const ReplicaStore replicas = state_->replicas;
  new (state_) State{};
  state_->own = own;
  state_->replicas = replicas;
  state_->start(settings);
}

void Synchroniser::State::start(const Settings& s) {
  settings = s;
  settings.slots = std::clamp(s.slots, 1, kMaxReplicas);
  random = Random(s.seed, s.robot);
  own.clear();
  own.set_rest(s.rest);
  replicas.clear();
  size_budgets();
}

bool Synchroniser::set_own(const LandmarkRecord& record) {
  const OwnRecords::Outcome outcome = state_->own.set(record);
  if (outcome == OwnRecords::Outcome::kTaken) return true;
  ++state_->counters.own_refused;
  return false;
}

void Synchroniser::reset_own(std::uint32_t new_map) {
  State& s = *state_;
  s.own.clear();
  s.settings.map = new_map;
  s.state_due = Time{};
  s.flush = {};
  for (Session& session : s.sessions) session.wanted.clear();
  for (Slot& slot : s.slots) slot.status.about_us_heard = false;
}

void Synchroniser::set_state(const Pose2& T_start_robot, Health health,
                             std::span<const OwnAlignment> alignments) {
  State& s = *state_;
  s.T_start_robot = T_start_robot;
  s.health = health;
  s.alignments.clear();
  for (Slot& slot : s.slots) slot.merged = false;
  for (const OwnAlignment& alignment : alignments) {
    if (alignment.slot < 0 || alignment.slot >= kMaxReplicas) continue;  // of another thread
    s.alignments.push_back(alignment);
    Slot& slot = s.slots[static_cast<std::size_t>(alignment.slot)];
    slot.merged = alignment.state == AlignmentNotice::State::kMerged;
  }
}

void Synchroniser::set_copies_to_everybody(int copies) {
  copies = std::max(copies, 1);
  if (copies == state_->copies) return;
  state_->copies = copies;
  state_->size_budgets();
}

void Synchroniser::State::size_budgets() {
  const auto largest = static_cast<std::uint32_t>(cost(kMaxPayload, kEverybody));
  all.configure(settings.max_rate, largest);
  news.configure_average(std::min(settings.news_rate, settings.max_rate), all.burst());
}

std::size_t Synchroniser::State::largest_payload(int to) const {
  const std::size_t each = all.burst() / static_cast<std::size_t>(to == kEverybody ? copies : 1);
  const std::size_t around = kFrameBytes + settings.headers_below;
  const std::size_t largest = each <= around ? 0 : std::min(kMaxPayload, each - around);
  return largest < kRecordsHeader + kMaxRecordBytes ? 0 : largest;
}

void Synchroniser::say_bye() {
  state_->bye_due = true;
}

void Synchroniser::join(Time now, int session, const Sender& sender) {
  leave(now, session);
  Session& s = state_->sessions[static_cast<std::size_t>(session)];
  s.joined = true;
  s.sender = sender;
  s.received.configure_average(state_->settings.peer_rate, state_->settings.peer_rate);
}

void Synchroniser::change_key(int session, std::uint16_t key) {
  state_->sessions[static_cast<std::size_t>(session)].sender.key = key;
}

void Synchroniser::leave(Time /*now*/, int session) {
  ensure(session >= 0 && session < kMaxSessions, "Synchroniser: no such session");
  Session& s = state_->sessions[static_cast<std::size_t>(session)];
  if (s.slot >= 0) {
    Slot& slot = state_->slots[static_cast<std::size_t>(s.slot)];
    slot.status.session = -1;
    slot.asking = false;
  }
  s = Session{};
}

bool Synchroniser::quarantined(Time now, int session) const {
  const Session& s = state_->sessions[static_cast<std::size_t>(session)];
  return s.joined && state_->quarantine.holds(now, s.sender);
}

void Synchroniser::fault(Time now, int session, RecordSink& sink) {
  state_->fault(now, session, sink);
}

void Synchroniser::State::fault(Time now, int session, RecordSink& sink) {
  if (!is_joined(session)) return;
  Session& from = sessions[static_cast<std::size_t>(session)];
  if (!quarantine.fault(now, from.sender)) return;
  ++counters.quarantines;
  for (int slot = 0; slot < kMaxReplicas; ++slot) {
    const PeerStatus& status = slots[static_cast<std::size_t>(slot)].status;
    const bool is_its_own = status.robot == from.sender.robot && status.boot == from.sender.boot;
    if (status.used && is_its_own) clear_slot(slot, sink);
  }
  from.wanted.clear();
  from.state_heard = false;
  from.highest = 0;
  from.highest_counter = 0;
  from.records_counter = 0;
}

// --- slots --------------------------------------------------------------------------------------

int Synchroniser::State::find_slot(const Sender& sender, std::uint32_t map) const {
  for (int slot = 0; slot < kMaxReplicas; ++slot) {
    const PeerStatus& status = slots[static_cast<std::size_t>(slot)].status;
    const bool is_its_own = status.robot == sender.robot && status.boot == sender.boot;
    if (status.used && is_its_own && status.map == map) return slot;
  }
  return -1;
}

// A slot without a peer, or that of the silent peer that is missed least: not merged, then longest
// not heard of.
int Synchroniser::State::free_slot(RecordSink& sink) {
  int least = -1;
  for (int i = 0; i < settings.slots; ++i) {
    const Slot& slot = slots[static_cast<std::size_t>(i)];
    if (!slot.status.used) return i;
    if (slot.status.session >= 0) continue;
    const Slot& other = slots[static_cast<std::size_t>(std::max(least, 0))];
    const bool less =
        slot.merged != other.merged ? !slot.merged : slot.status.heard_at < other.status.heard_at;
    if (least < 0 || less) least = i;
  }
  if (least >= 0) clear_slot(least, sink);
  return least;
}

void Synchroniser::State::clear_slot(int slot, RecordSink& sink) {
  Slot& s = slots[static_cast<std::size_t>(slot)];
  if (s.status.session >= 0) sessions[static_cast<std::size_t>(s.status.session)].slot = -1;
  s = Slot{};
  replicas.forget_all(slot);
  sink.forget(slot);
}

// The slot of the peer's map as it is now; -1 when all are taken by others that are there.
int Synchroniser::State::attach(Time now, Session& from, int session, std::uint32_t map,
                                RecordSink& sink) {
  if (from.slot >= 0) {
    Slot& old = slots[static_cast<std::size_t>(from.slot)];
    old.status.session = -1;
    old.asking = false;
    from.slot = -1;
  }
  int slot = find_slot(from.sender, map);
  if (slot >= 0 && slots[static_cast<std::size_t>(slot)].lost) {
    clear_slot(slot, sink);
  } else if (slot < 0) {
    slot = free_slot(sink);
    if (slot < 0) return -1;
  }
  Slot& s = slots[static_cast<std::size_t>(slot)];
  if (s.status.session >= 0) sessions[static_cast<std::size_t>(s.status.session)].slot = -1;
  s.status.used = true;
  s.status.robot = from.sender.robot;
  s.status.boot = from.sender.boot;
  s.status.map = map;
  s.status.session = session;
  s.status.heard_at = now;
  from.slot = slot;
  from.map_began = now;
  from.highest = 0;
  from.highest_counter = 0;
  from.records_counter = 0;
  return slot;
}

// Gives up the lists of silent peers until so many records are free; what was taken of them stays.
bool Synchroniser::State::reclaim_records(std::size_t wanted) {
  while (replicas.room() < wanted) {
    int longest = -1;
    for (int i = 0; i < kMaxReplicas; ++i) {
      const Slot& slot = slots[static_cast<std::size_t>(i)];
      if (slot.status.session >= 0 || replicas.replica(i).records == 0) continue;
      if (longest < 0 ||
          slot.status.heard_at < slots[static_cast<std::size_t>(longest)].status.heard_at) {
        longest = i;
      }
    }
    if (longest < 0) return false;
    replicas.forget_all(longest);
    slots[static_cast<std::size_t>(longest)].lost = true;
  }
  return true;
}

// --- reading ------------------------------------------------------------------------------------

const PeerStatus& Synchroniser::peer(int slot) const {
  return state_->slots[static_cast<std::size_t>(slot)].status;
}

int Synchroniser::slot_of(int session) const {
  return state_->sessions[static_cast<std::size_t>(session)].slot;
}

const Counters& Synchroniser::counters() const {
  state_->counters.tombstones_forgotten = state_->own.forgotten();
  return state_->counters;
}

}  // namespace zenith::exchange
