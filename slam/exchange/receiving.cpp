// The receiving side of the Synchroniser: what peers tell, and what is missing of it.

#include <algorithm>
#include <cmath>

#include "slam/exchange/synchroniser_state.h"

namespace zenith::exchange {
namespace {

// Gaps close by themselves when datagrams only came in another order.
constexpr double kNoticeFrom_s = 0.1;
constexpr double kNoticeTo_s = 0.3;
// The more hear the same news, the more of them lack something, and the longer each waits with what
// little it lacks: meanwhile much of it is told anew, or somebody else asks.
constexpr double kWaitForEach_s = 0.2;
constexpr double kWaitAtMost_s = 10.0;
constexpr std::uint32_t kLittle = 64;  // revisions: of a datagram or two
constexpr Duration kAskAgain = Duration::from_seconds(1.0);
// Others who lack the same may ask, too.
constexpr Duration kGather = Duration::from_seconds(0.2);
// What finds no room is asked for again later and later.
constexpr Duration kFirstFull = Duration::from_seconds(1.0);
constexpr Duration kLongestFull = Duration::from_seconds(64.0);
constexpr Duration kFirstDoubt = Duration::from_seconds(10.0);
constexpr Duration kLongestDoubt = Duration::from_seconds(640.0);
// A map that begins anew more often is a fault.
constexpr Duration kMapLives = Duration::from_seconds(10.0);
// A map is corrected where a loop closes, by metres at worst.
constexpr float kJump_m = 10.0F;
constexpr float kJumpDeviations = 6.0F;
constexpr std::uint32_t kRemovalsKept = 64;

bool is_fault(Verdict verdict) {
  return verdict == Verdict::kMalformed || verdict == Verdict::kInconsistent ||
         verdict == Verdict::kTooMuch;
}

bool jumps(const ForeignRecord& known, const LandmarkRecord& news) {
  if (!known.present || news.removed) return false;
  const float deviation = std::sqrt(std::max(news.covariance_m2[0], news.covariance_m2[3]));
  const float limit = kJump_m + kJumpDeviations * (deviation + known.deviation_m);
  return std::hypot(news.x_m - known.x_m, news.y_m - known.y_m) > limit;
}

}  // namespace

Verdict Synchroniser::receive(Time now, int session, std::uint64_t counter, Bytes payload,
                              RecordSink& sink) {
  State& s = *state_;
  ++s.counters.datagrams_received;
  if (!s.is_joined(session)) {  // nobody's: not looked at
    ++s.counters.quarantined;
    return Verdict::kQuarantined;
  }
  Session& from = s.sessions[static_cast<std::size_t>(session)];
  if (s.quarantine.holds(now, from.sender)) {
    ++s.counters.quarantined;
    return Verdict::kQuarantined;
  }
  Verdict verdict = Verdict::kUsed;
  if (!from.received.spend(now, s.cost(payload.size(), session))) {
    verdict = Verdict::kTooMuch;
  } else if (!well_formed(payload)) {
    verdict = Verdict::kMalformed;
  }
  SectionReader sections(payload);
  Section section;
  while (!is_fault(verdict) && sections.next(section)) {
    Verdict one = Verdict::kUsed;
    if (section.is(SectionType::kState)) {
      one = s.take_state(now, session, counter, section.body, sink);
    } else if (section.is(SectionType::kRecords)) {
      one = s.take_records(now, session, counter, section.body, sink);
    } else if (section.is(SectionType::kRequest)) {
      s.take_request(now, from, section.body);
    }
    if (one != Verdict::kUsed) verdict = one;
  }
  s.counters.malformed += verdict == Verdict::kMalformed ? 1 : 0;
  s.counters.inconsistent += verdict == Verdict::kInconsistent ? 1 : 0;
  s.counters.too_much += verdict == Verdict::kTooMuch ? 1 : 0;
  s.counters.no_room += verdict == Verdict::kNoRoom ? 1 : 0;
  if (is_fault(verdict)) s.fault(now, session, sink);
  return verdict;
}

// --- STATE --------------------------------------------------------------------------------------

Verdict Synchroniser::State::take_state(Time now, int session, std::uint64_t counter, Bytes body,
                                        RecordSink& sink) {
  Session& from = sessions[static_cast<std::size_t>(session)];
  if (from.state_heard && counter <= from.state_counter) return Verdict::kUsed;  // an older one
  StateNotice state;
  if (!decode(body, state)) return Verdict::kMalformed;  // well_formed() has read it once

  const bool same_map =
      from.slot >= 0 && slots[static_cast<std::size_t>(from.slot)].status.map == state.map;
  bool quiet = false;
  if (same_map) {
    const PeerStatus& before = slots[static_cast<std::size_t>(from.slot)].status;
    if (from.state_heard && state.head < before.state.head) return Verdict::kInconsistent;
    if (counter > from.highest_counter && state.head < from.highest) return Verdict::kInconsistent;
    quiet = state.head == before.state.head;
  } else {
    const bool began_before = from.slot >= 0;
    if (began_before && now - from.map_began < kMapLives) return Verdict::kInconsistent;
    if (attach(now, from, session, state.map, sink) < 0) {
      if (!from.state_heard) ++counters.slots_refused;
      from.state_heard = true;
      from.state_counter = counter;
      return Verdict::kNoRoom;
    }
  }
  from.state_heard = true;
  from.state_counter = counter;
  Slot& slot = slots[static_cast<std::size_t>(from.slot)];
  slot.status.heard = true;
  slot.status.heard_at = now;
  slot.status.state = state;
  take_alignments(slot);
  look_for_gaps(now, from.slot, sink);
  if (quiet && slot.asking && !slot.asked) {  // nothing will be told anew
    slot.due = std::min(slot.due, soon(now));
  }
  // Records that were sent after this state may have superseded what it tells of.
  if (from.records_counter < counter) compare(now, from.slot);
  return Verdict::kUsed;
}

void Synchroniser::State::take_alignments(Slot& slot) {
  for (const AlignmentNotice& alignment : slot.status.state.alignments) {
    if (alignment.robot != settings.robot || alignment.map != settings.map) continue;
    slot.status.about_us_heard = true;
    slot.status.about_us = alignment;
  }
}

// All is here that the last state told of: then the checksums are of the same.
void Synchroniser::State::compare(Time now, int slot) {
  Slot& s = slots[static_cast<std::size_t>(slot)];
  const Replica& replica = replicas.replica(slot);
  const StateNotice& told = s.status.state;
  if (s.asking || s.doubted || replica.highest > told.head) return;
  s.agreed = replica.checksum == told.checksum && replica.present == told.present;
  s.status.complete = s.agreed;
  if (s.agreed) {
    s.doubt_wait = kFirstDoubt;
    if (replica.records > replica.present + kRemovalsKept) replicas.purge_removals(slot);
    return;
  }
  if (now < s.doubt_at) return;
  ++counters.checksum_differed;
  if (s.doubt_wait < kFirstDoubt) s.doubt_wait = kFirstDoubt;
  s.doubt_at = now + s.doubt_wait;
  s.doubt_wait = std::min(s.doubt_wait + s.doubt_wait, kLongestDoubt);
  s.doubted = true;
  replicas.doubt(slot);
  s.asking = told.head > 0;  // else there is nothing to ask for, and all that is here is too much
  s.asked = false;
  s.due = soon(now);
}

// When to ask for what was just noticed to be missing.
Time Synchroniser::State::ask_at(Time now, std::uint32_t missing) {
  if (missing > kLittle) return soon(now);
  const auto others = std::count_if(sessions.begin(), sessions.end(),
                                    [](const Session& session) { return session.joined; });
  const double wait_s = kWaitForEach_s * static_cast<double>(others - 1);
  return soon(now) + Duration::from_seconds(std::min(wait_s, kWaitAtMost_s));
}

Time Synchroniser::State::soon(Time now) {
  return now + Duration::from_seconds(random.uniform(kNoticeFrom_s, kNoticeTo_s));
}

void Synchroniser::State::look_for_gaps(Time now, int slot, RecordSink& sink) {
  Slot& s = slots[static_cast<std::size_t>(slot)];
  const Replica& replica = replicas.replica(slot);
  const std::uint32_t head = std::max(s.status.state.head, replica.highest);
  s.status.landmarks = replica.present;
  if (!replica.had.covers({1, head})) {
    s.agreed = false;
    s.status.complete = false;
    const std::uint32_t missing = replica.had.missing({1, head});
    if (s.asking && (s.asked || missing <= kLittle)) return;
    const Time due = ask_at(now, missing);
    s.due = s.asking ? std::min(s.due, due) : due;
    s.asking = true;
    s.asked = false;
    s.progress = false;
    return;
  }
  s.asking = false;
  if (s.doubted) sweep(slot, sink);
  s.status.landmarks = replica.present;
  s.status.complete = s.agreed && !s.doubted;
}

// What was not told again is not there any more.
void Synchroniser::State::sweep(int slot, RecordSink& sink) {
  Slot& s = slots[static_cast<std::size_t>(slot)];
  for (std::size_t room = sink.room(slot); room > 0; --room) {
    LandmarkRecord removal;
    if (!replicas.sweep_one(slot, removal)) {
      s.doubted = false;
      return;
    }
    sink.take(slot, removal);
  }
}

// --- RECORDS ------------------------------------------------------------------------------------

Verdict Synchroniser::State::take_records(Time now, int session, std::uint64_t counter, Bytes body,
                                          RecordSink& sink) {
  Session& from = sessions[static_cast<std::size_t>(session)];
  RecordsReader records(body);
  const Range range = records.header().range;
  const std::uint32_t map = records.header().map;
  if (from.slot < 0 || slots[static_cast<std::size_t>(from.slot)].status.map != map) {
    ++counters.other_map;
    return Verdict::kUsed;
  }
  Slot& slot = slots[static_cast<std::size_t>(from.slot)];
  if (counter < from.state_counter && range.last > slot.status.state.head) {
    return Verdict::kInconsistent;  // a later state told of a lower head
  }
  from.records_counter = std::max(from.records_counter, counter);
  const Verdict verdict = check_records(from.slot, body, sink);
  if (verdict == Verdict::kNoRoom) {
    slot.full_wait = std::clamp(slot.full_wait + slot.full_wait, kFirstFull, kLongestFull);
    slot.due = std::max(slot.due, now + slot.full_wait);
  }
  if (verdict != Verdict::kUsed) return verdict;
  slot.full_wait = {};
  if (range.last > from.highest) {
    from.highest = range.last;
    from.highest_counter = counter;
  }

  const bool was_missing = !replicas.replica(from.slot).had.covers(range);
  LandmarkRecord record;
  while (records.next(record)) {
    ++counters.records_received;
    if (!replicas.is_new(from.slot, record)) {
      replicas.confirm(from.slot, record.id, record.revision);
      continue;
    }
    ++counters.records_new;
    replicas.apply(from.slot, record);
    sink.take(from.slot, record);
  }
  replicas.cover(from.slot, range);
  if (was_missing && slot.asked && range.first <= slot.asked_last) {
    slot.progress = true;
    slot.due = std::max(slot.due, now + kAskAgain);
  }
  look_for_gaps(now, from.slot, sink);
  return Verdict::kUsed;
}

// Looks at the whole section before any of it is used.
Verdict Synchroniser::State::check_records(int slot, Bytes body, RecordSink& sink) {
  std::size_t count = 0;
  std::size_t unknown = 0;
  RecordsReader records(body);
  LandmarkRecord record;
  while (records.next(record)) {
    if (!replicas.is_new(slot, record)) continue;
    ++count;
    const ForeignRecord* known = replicas.find(slot, record.id);
    if (known == nullptr) {
      ++unknown;
    } else if (jumps(*known, record)) {
      return Verdict::kInconsistent;
    }
  }
  const Replica& replica = replicas.replica(slot);
  if (replica.records + unknown > kMaxRecordsOfPeer) replicas.purge_removals(slot);
  if (replica.records + unknown > kMaxRecordsOfPeer) return Verdict::kTooMuch;
  if (count > sink.room(slot)) return Verdict::kNoRoom;
  if (replicas.room() < unknown && !reclaim_records(unknown)) return Verdict::kNoRoom;
  return Verdict::kUsed;
}

// --- REQUEST ------------------------------------------------------------------------------------

void Synchroniser::State::take_request(Time now, Session& from, Bytes body) {
  Request request;
  if (!decode(body, request)) return;
  if (request.robot != settings.robot || request.map != settings.map) return;
  ++counters.requests_received;
  if (from.wanted.empty()) from.serve_at = now + kGather;
  for (const Range& range : request.ranges) {
    const Range told = {range.first, std::min(range.last, own.head())};
    if (told.first <= told.last) from.wanted.add(told);
  }
}

}  // namespace zenith::exchange
