// The sending side of the Synchroniser: what is due, in which order.

#include <algorithm>
#include <cassert>

#include "slam/exchange/synchroniser_state.h"

namespace zenith::exchange {
namespace {

constexpr double kStateEvery_s = 1.0;
constexpr double kStateJitter_s = 0.05;
constexpr Duration kAskAgain = Duration::from_seconds(1.0);
// Most often a datagram was lost; a peer that cannot hear us is asked more seldom.
constexpr int kPatience = 4;
constexpr Duration kAskSlowly = Duration::from_seconds(4.0);
// Requests that are due so soon go along; what was not asked for yet, also earlier.
constexpr Duration kAskTogether = Duration::from_seconds(0.1);
constexpr Duration kFirstTogether = Duration::from_seconds(2.0);

using Queue = OwnRecords::Queue;

}  // namespace

Outgoing Synchroniser::next(Time now, std::span<std::uint8_t> out) {
  State& s = *state_;
  assert(out.size() >= kMaxPayload);
  if (s.over) return {};
  if (s.bye_due) return s.send_bye(now, out);
  if (s.state_due <= now) return s.send_state(now, out);
  // All else waits until the largest datagram can be sent, so that none is cut short.
  if (const Outgoing o = s.send_requests(now, out); o.size > 0) return o;
  if (s.news_due(Queue::kNew)) return s.send_news(now, out, Queue::kNew);
  for (int turn = 0; turn < 2; ++turn) {
    s.serves_next = !s.serves_next;
    const Outgoing o = s.serves_next ? s.serve(now, out) : s.send_news(now, out, Queue::kChanged);
    if (o.size > 0) return o;
  }
  return {};
}

bool Synchroniser::spend(Time now, std::size_t payload_bytes) {
  State& s = *state_;
  const std::size_t bytes = s.cost(payload_bytes, 0);
  if (!s.all.spend(now, bytes)) return false;
  ++s.counters.datagrams_sent;
  s.counters.bytes_sent += bytes;
  return true;
}

Outgoing Synchroniser::State::sent(Time now, int to, const ByteWriter& out) {
  assert(!out.failed() && out.size() > 0);
  const std::size_t bytes = cost(out.size(), to);
  [[maybe_unused]] const bool paid = all.spend(now, bytes);
  assert(paid);
  counters.datagrams_sent += to == kEverybody ? static_cast<std::uint64_t>(copies) : 1;
  counters.bytes_sent += bytes;
  return {to, out.size()};
}

Outgoing Synchroniser::State::send_bye(Time now, std::span<std::uint8_t> out) {
  ByteWriter writer(out);
  append_bye(writer);
  if (all.available(now) < cost(writer.size(), kEverybody)) return {};
  over = true;
  return sent(now, kEverybody, writer);
}

// --- STATE --------------------------------------------------------------------------------------

std::size_t Synchroniser::State::state_bytes() const {
  return kStateBytes + kAlignmentBytes * std::min(alignments.size(), kMaxAlignmentsTold) +
         (hello_next ? kSectionHeader + 1 + settings.name.name.size() : 0);
}

StateNotice Synchroniser::State::state_notice() {
  StateNotice notice;
  notice.map = settings.map;
  notice.head = own.head();
  notice.present = own.present();
  notice.checksum = own.checksum();
  notice.T_start_robot = T_start_robot;
  notice.health = health;
  const std::size_t count = std::min(alignments.size(), kMaxAlignmentsTold);
  for (std::size_t k = 0; k < count; ++k) {
    const OwnAlignment& a = alignments[(next_alignment + k) % alignments.size()];
    const PeerStatus& peer = slots[static_cast<std::size_t>(a.slot)].status;
    if (!peer.used) continue;
    notice.alignments.push_back(
        {peer.robot, peer.map, a.state, a.T_own_peer, a.deviations,
         static_cast<std::uint16_t>(std::clamp(a.correspondences, 0, 65535)), a.confidence});
  }
  if (count > 0) next_alignment = (next_alignment + count) % alignments.size();
  return notice;
}

Outgoing Synchroniser::State::send_state(Time now, std::span<std::uint8_t> out) {
  if (nobody_there()) own.tell_nobody();
  own.advance(now);
  const std::size_t affordable = all.available(now) / static_cast<std::size_t>(copies);
  const std::size_t around = kFrameBytes + settings.headers_below;
  if (affordable < state_bytes() + around) return {};
  ByteWriter writer(out.first(std::clamp(affordable - around, state_bytes(), kMaxPayload)));
  append(writer, state_notice());
  if (hello_next) append(writer, settings.name);
  hello_next = !hello_next;
  ++counters.states_sent;
  state_due =
      now + Duration::from_seconds(kStateEvery_s + random.uniform(-kStateJitter_s, kStateJitter_s));
  for (const Queue queue : {Queue::kNew, Queue::kChanged}) {
    flush[static_cast<std::size_t>(queue)] = own.waiting(queue);
  }
  append_news(now, writer);
  return sent(now, kEverybody, writer);
}

// --- REQUEST ------------------------------------------------------------------------------------

Outgoing Synchroniser::State::send_requests(Time now, std::span<std::uint8_t> out) {
  int due = -1;
  for (int i = 0; i < kMaxReplicas; ++i) {
    const Slot& slot = slots[static_cast<std::size_t>(i)];
    if (!slot.asking || slot.due > now) continue;
    if (due < 0 || slot.due < slots[static_cast<std::size_t>(due)].due) due = i;
  }
  const std::size_t largest = largest_payload(0);
  if (due < 0 || largest == 0 || all.available(now) < cost(largest, 0)) return {};
  ByteWriter writer(out.first(largest));
  append_request(now, due, writer);
  int to = slots[static_cast<std::size_t>(due)].status.session;
  if (copies > 1) return writer.size() > 0 ? sent(now, to, writer) : Outgoing{};
  for (int i = 0; i < kMaxReplicas; ++i) {
    const Slot& slot = slots[static_cast<std::size_t>(i)];
    if (!slot.asking || slot.due > now + (slot.asked ? kAskTogether : kFirstTogether)) continue;
    if (!append_request(now, i, writer)) break;
    to = kEverybody;
  }
  return writer.size() > 0 ? sent(now, to, writer) : Outgoing{};
}

// False when there is no room for it.
bool Synchroniser::State::append_request(Time now, int slot, ByteWriter& out) {
  Slot& s = slots[static_cast<std::size_t>(slot)];
  const Replica& replica = replicas.replica(slot);
  const std::uint32_t head = std::max(s.status.state.head, replica.highest);
  Request request;
  request.robot = s.status.robot;
  request.map = s.status.map;
  Range gap;
  for (std::uint32_t from = 1; replica.had.first_gap({from, head}, gap); from = gap.last + 1) {
    if (!request.ranges.push_back(gap)) break;
  }
  if (request.ranges.empty()) {
    s.asking = false;
    return true;
  }
  if (!append(out, request)) return false;
  ++counters.requests_sent;
  s.fruitless = !s.asked || s.progress ? 0 : s.fruitless + 1;
  const Duration wait = s.fruitless < kPatience ? kAskAgain : kAskSlowly;
  s.asked = true;
  s.progress = false;
  s.asked_last = head;
  s.due = now + Duration::from_seconds(wait.seconds() * random.uniform(1.0, 1.2));
  return true;
}

// --- news ---------------------------------------------------------------------------------------

bool Synchroniser::State::nobody_there() const {
  return std::none_of(sessions.begin(), sessions.end(), [](const Session& s) { return s.joined; });
}

bool Synchroniser::State::news_due(Queue queue) const {
  const std::size_t largest = largest_payload(kEverybody);
  if (largest == 0 || own.waiting(queue) == 0 || nobody_there()) return false;
  return flush[static_cast<std::size_t>(queue)] > 0 ||
         own.waiting_bytes(queue) >= largest - kRecordsHeader;
}

Outgoing Synchroniser::State::send_news(Time now, std::span<std::uint8_t> out, Queue queue) {
  if (!news_due(queue)) return {};
  const std::size_t largest = largest_payload(kEverybody);
  const std::size_t bytes = cost(largest, kEverybody);
  if (all.available(now) < bytes) return {};
  if (queue == Queue::kChanged && news.available(now) < bytes) return {};
  ByteWriter writer(out.first(largest));
  append_news(now, writer);
  return writer.size() > 0 ? sent(now, kEverybody, writer) : Outgoing{};
}

// New landmarks and removals first, then changes as far as their own budget goes.
void Synchroniser::State::append_news(Time now, ByteWriter& out) {
  if (out.left() < kRecordsHeader) return;
  RecordsWriter records(out, settings.map, own.head() + 1);
  const auto times = static_cast<std::size_t>(copies);
  const std::size_t around = kFrameBytes + settings.headers_below + kRecordsHeader;
  std::size_t changed = 0;
  for (const Queue queue : {Queue::kNew, Queue::kChanged}) {
    std::size_t& flushed = flush[static_cast<std::size_t>(queue)];
    while (own.waiting(queue) > 0 && records.count() < kMaxRecordsInSection) {
      const std::size_t bytes = own.next_bytes(queue);
      if (bytes > out.left()) break;
      if (queue == Queue::kChanged) {
        if (news.available(now) < (around + changed + bytes) * times) break;
        changed += bytes;
      }
      own.tell_next(now, queue, records);
      if (flushed > 0) --flushed;
    }
    if (own.waiting(queue) == 0) flushed = 0;
  }
  counters.news_sent += records.count();
  if (changed > 0) news.spend(now, (around + changed) * times);
  if (records.count() == 0 || !records.finish(own.head())) records.cancel();
}

// --- what was asked for -------------------------------------------------------------------------

// By turns among those who asked.
int Synchroniser::State::next_to_serve(Time now) const {
  for (int k = 1; k <= kMaxSessions; ++k) {
    const int i = (last_served + k) % kMaxSessions;
    const Session& session = sessions[static_cast<std::size_t>(i)];
    if (!session.wanted.empty() && session.serve_at <= now) return i;
  }
  return -1;
}

int Synchroniser::State::lacking(std::uint32_t revision) const {
  return static_cast<int>(std::count_if(sessions.begin(), sessions.end(), [&](const Session& s) {
    return s.wanted.contains(revision);
  }));
}

void Synchroniser::State::served(Range range, int to) {
  for (int i = 0; i < kMaxSessions; ++i) {
    if (to == kEverybody || to == i) sessions[static_cast<std::size_t>(i)].wanted.remove(range);
  }
}

Outgoing Synchroniser::State::serve(Time now, std::span<std::uint8_t> out) {
  const int session = next_to_serve(now);
  if (session < 0) return {};
  Session& asker = sessions[static_cast<std::size_t>(session)];
  const int to = lacking(asker.wanted.ranges()[0].first) > copies ? kEverybody : session;
  const std::size_t largest = largest_payload(to);
  if (largest == 0 || all.available(now) < cost(largest, to)) return {};
  last_served = session;
  ByteWriter writer(out.first(largest));
  while (!asker.wanted.empty()) {
    const Range wanted = asker.wanted.ranges()[0];
    RecordsWriter records(writer, settings.map, wanted.first);
    const std::uint32_t last = own.write_told(wanted, records);
    if (last < wanted.first || !records.finish(last)) {
      records.cancel();
      break;
    }
    counters.served_sent += records.count();
    served({wanted.first, last}, to);
    if (last < wanted.last) break;
  }
  return sent(now, to, writer);
}

// --- when ---------------------------------------------------------------------------------------

Time Synchroniser::when_spent(Time now, std::size_t payload_bytes) const {
  return state_->all.when(now, state_->cost(payload_bytes, 0));
}

Time Synchroniser::next_time(Time now) const {
  const State& s = *state_;
  if (s.over) return now + Duration::from_seconds(3600.0);
  if (s.bye_due) return s.all.when(now, s.cost(kSectionHeader, kEverybody));
  if (s.state_due <= now) return s.all.when(now, s.cost(s.state_bytes(), kEverybody));
  const auto affordable = [&](Time due, const Budget& budget, int to) {
    const std::size_t largest = s.largest_payload(to);
    if (largest == 0) return now + Duration::from_seconds(3600.0);
    return std::max(due, budget.when(now, s.cost(largest, to)));
  };
  Time first = s.state_due;
  for (const Slot& slot : s.slots) {
    if (slot.asking) first = std::min(first, affordable(slot.due, s.all, 0));
  }
  // As in next(): what comes first waits for its budget, and all that comes after it waits, too.
  if (s.news_due(Queue::kNew)) {
    return std::max(now, std::min(first, affordable(now, s.all, kEverybody)));
  }
  if (const int session = s.next_to_serve(now); session >= 0) {
    const Session& asker = s.sessions[static_cast<std::size_t>(session)];
    const bool many = s.lacking(asker.wanted.ranges()[0].first) > s.copies;
    first = std::min(first, affordable(now, s.all, many ? kEverybody : 0));
  } else {
    for (const Session& later : s.sessions) {
      if (!later.wanted.empty()) first = std::min(first, affordable(later.serve_at, s.all, 0));
    }
  }
  if (s.news_due(Queue::kChanged)) {
    const Time both = affordable(affordable(now, s.all, kEverybody), s.news, kEverybody);
    first = std::min(first, both);
  }
  return std::max(first, now);
}

}  // namespace zenith::exchange
