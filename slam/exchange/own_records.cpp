#include "slam/exchange/own_records.h"

#include <algorithm>
#include <cassert>

#include "platform/base/ensure.h"
#include "slam/exchange/checksum.h"

namespace zenith::exchange {

void OwnRecords::layout(Arena& arena) {
  entries_ = arena.take<Entry>(kMaxOwnRecords);
  free_ = arena.take<std::int32_t>(kMaxOwnRecords);
  table_.layout(arena, kMaxOwnRecords);
  for (Ring& ring : rings_) ring.slots = arena.take<std::int32_t>(kMaxOwnRecords);
  told_ = arena.take<Told>(2 * kMaxOwnRecords);
}

void OwnRecords::clear() {
  for (std::size_t i = 0; i < free_.size(); ++i) {
    free_[i] = static_cast<std::int32_t>(free_.size() - 1 - i);
  }
  free_count_ = free_.size();
  table_.clear();
  for (Ring& ring : rings_) ring.first = ring.count = ring.bytes = 0;
  told_count_ = 0;
  head_ = 0;
  present_ = 0;
  checksum_ = 0;
}

OwnRecords::Outcome OwnRecords::set(const LandmarkRecord& record) {
  EncodedRecord encoded;
  if (!encode_record(record, encoded)) return Outcome::kUntellable;
  std::int32_t i = table_.find(record.id, id_of());
  if (i < 0) {
    if (record.removed) return Outcome::kTaken;  // nobody knows it
    i = enter(record.id);
    if (i < 0) return Outcome::kFull;
  }
  wait_no_more(i);
  Entry& e = entry(i);
  e.newest = encoded;
  e.newest_removed = record.removed;
  const bool untold = e.revision == 0;
  if (!(untold && record.removed)) {
    wait(i);
  } else if (e.queue < 0) {
    release(i);
  }
  trim(rings_[index(Queue::kNew)]);
  trim(rings_[index(Queue::kChanged)]);
  return Outcome::kTaken;
}

std::int32_t OwnRecords::enter(std::uint32_t id) {
  if (free_count_ == 0 && !forget_a_removal()) return -1;
  const std::int32_t i = free_[--free_count_];
  entry(i) = Entry{};
  entry(i).id = id;
  table_.enter(id, i, id_of());
  return i;
}

void OwnRecords::release(std::int32_t i) {
  table_.forget(entry(i).id, id_of());
  entry(i) = Entry{};
  free_[free_count_++] = i;
}

// The oldest one that was told; what still waits is kept.
bool OwnRecords::forget_a_removal() {
  for (const Told& told : told_.first(told_count_)) {
    const Entry& e = entry(told.entry);
    if (e.revision != told.revision || !e.told_removed || e.queue >= 0) continue;
    release(told.entry);
    ++forgotten_;
    return true;
  }
  return false;
}

void OwnRecords::push(std::size_t ring, std::int32_t i) {
  Ring& r = rings_[ring];
  assert(entry(i).queue < 0);
  ensure(r.count < r.slots.size(), "OwnRecords: a queue holds each record once");
  entry(i).queue = static_cast<std::int8_t>(ring);
  r.slots[(r.first + r.count++) % r.slots.size()] = i;
}

// The entry's newest state is to be told: from where it stands already, or else at a queue's end.
void OwnRecords::wait(std::int32_t i) {
  Entry& e = entry(i);
  if (e.queue < 0)
    push(index(e.revision == 0 || e.newest_removed ? Queue::kNew : Queue::kChanged), i);
  e.waits = true;
  rings_[static_cast<std::size_t>(e.queue)].bytes += e.newest.size;
}

void OwnRecords::advance(Time now) {
  Ring& resting = rings_[kResting];
  while (resting.count > 0) {
    const std::int32_t i = resting.slots[resting.first];
    if (now - entry(i).told_at < rest_) return;
    const bool waited = entry(i).waits;
    wait_no_more(i);
    pop(resting);
    if (waited) wait(i);
  }
}

void OwnRecords::wait_no_more(std::int32_t i) {
  Entry& e = entry(i);
  if (e.waits) rings_[static_cast<std::size_t>(e.queue)].bytes -= e.newest.size;
  e.waits = false;
}

// Takes out of the front what does not wait any more.
void OwnRecords::trim(Ring& ring) {
  while (ring.count > 0 && !entry(ring.slots[ring.first]).waits) {
    const std::int32_t i = pop(ring);
    if (entry(i).revision == 0) release(i);
  }
}

std::int32_t OwnRecords::pop(Ring& ring) {
  const std::int32_t i = ring.slots[ring.first];
  ring.first = (ring.first + 1) % ring.slots.size();
  --ring.count;
  entry(i).queue = -1;
  return i;
}

std::size_t OwnRecords::next_bytes(Queue queue) const {
  const Ring& ring = rings_[index(queue)];
  return ring.count == 0 ? 0 : entry(ring.slots[ring.first]).newest.size;
}

void OwnRecords::tell_next(Time now, Queue queue, RecordsWriter& out) {
  Ring& ring = rings_[index(queue)];
  const std::int32_t i = ring.slots[ring.first];
  tell_front(ring);
  Entry& e = entry(i);
  [[maybe_unused]] const bool fits = out.add(e.told, e.revision);
  assert(fits);
  e.told_at = now;
  if (!e.told_removed) push(kResting, i);
  trim(ring);
}

void OwnRecords::tell_nobody() {
  Ring& resting = rings_[kResting];
  while (resting.count > 0) {
    if (entry(resting.slots[resting.first]).waits) {
      tell_front(resting);
    } else {
      pop(resting);
    }
  }
  for (const Queue queue : {Queue::kNew, Queue::kChanged}) {
    Ring& ring = rings_[index(queue)];
    while (ring.count > 0) {
      tell_front(ring);
      trim(ring);
    }
  }
}

// The entry at the front of the ring, told under the next revision.
void OwnRecords::tell_front(Ring& ring) {
  assert(ring.count > 0 && entry(ring.slots[ring.first]).waits);
  wait_no_more(ring.slots[ring.first]);
  const std::int32_t i = pop(ring);
  Entry& e = entry(i);
  if (told_present(e) != 0) checksum_ -= mix(e.id, e.revision);
  present_ -= told_present(e);
  e.told = e.newest;
  e.told_removed = e.newest_removed;
  e.revision = ++head_;
  if (told_present(e) != 0) checksum_ += mix(e.id, e.revision);
  present_ += told_present(e);
  note_told(i);
}

void OwnRecords::note_told(std::int32_t i) {
  if (told_count_ == told_.size()) {
    const auto all = told_.first(told_count_);
    const auto end = std::remove_if(all.begin(), all.end(), [this](const Told& told) {
      return entry(told.entry).revision != told.revision;
    });
    told_count_ = static_cast<std::size_t>(end - all.begin());
  }
  told_[told_count_++] = {entry(i).revision, i};
}

std::uint32_t OwnRecords::write_told(Range range, RecordsWriter& out) const {
  const auto all = told_.first(told_count_);
  auto it = std::lower_bound(all.begin(), all.end(), range.first,
                             [](const Told& t, std::uint32_t x) { return t.revision < x; });
  for (; it != all.end() && it->revision <= range.last; ++it) {
    const Entry& e = entry(it->entry);
    if (e.revision != it->revision) continue;
    if (!out.add(e.told, e.revision)) return e.revision - 1;
  }
  return range.last;
}

}  // namespace zenith::exchange
