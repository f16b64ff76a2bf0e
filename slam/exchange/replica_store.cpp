#include "slam/exchange/replica_store.h"

#include <algorithm>
#include <cmath>

#include "platform/base/ensure.h"
#include "slam/exchange/checksum.h"

namespace zenith::exchange {

static_assert(kMaxReplicas <= 256, "ForeignRecord::slot");

void ReplicaStore::layout(Arena& arena) {
  replicas_ = arena.take<Replica>(kMaxReplicas);
  records_ = arena.take<ForeignRecord>(kMaxForeignRecords);
  free_ = arena.take<std::int32_t>(kMaxForeignRecords);
  table_.layout(arena, kMaxForeignRecords);
}

void ReplicaStore::clear() {
  for (Replica& r : replicas_) r = Replica{};
  for (std::size_t i = 0; i < free_.size(); ++i) {
    free_[i] = static_cast<std::int32_t>(free_.size() - 1 - i);
  }
  free_count_ = free_.size();
  table_.clear();
}

const ForeignRecord* ReplicaStore::find(int slot, std::uint32_t id) const {
  const std::int32_t i = table_.find(key(slot, id), key_of());
  return i < 0 ? nullptr : &record(i);
}

bool ReplicaStore::is_new(int slot, const LandmarkRecord& r) const {
  if (replica(slot).had.contains(r.revision)) return false;
  const ForeignRecord* known = find(slot, r.id);
  return known == nullptr || known->revision < r.revision;
}

std::int32_t ReplicaStore::enter(int slot, std::uint32_t id) {
  ensure(free_count_ > 0, "ReplicaStore: no record is free");  // room() was asked before
  const std::int32_t i = free_[--free_count_];
  Replica& owner = replica(slot);
  ForeignRecord& r = record(i);
  r = ForeignRecord{};
  r.id = id;
  r.slot = static_cast<std::uint8_t>(slot);
  r.next = owner.first;
  if (owner.first >= 0) record(owner.first).previous = i;
  owner.first = i;
  ++owner.records;
  table_.enter(key(slot, id), i, key_of());
  return i;
}

void ReplicaStore::release(std::int32_t i) {
  const ForeignRecord r = record(i);
  Replica& owner = replica(r.slot);
  if (r.present) {
    owner.checksum -= mix(r.id, r.revision);
    --owner.present;
  }
  if (r.next >= 0) record(r.next).previous = r.previous;
  (r.previous >= 0 ? record(r.previous).next : owner.first) = r.next;
  --owner.records;
  table_.forget(key(r.slot, r.id), key_of());
  free_[free_count_++] = i;
}

void ReplicaStore::apply(int slot, const LandmarkRecord& news) {
  std::int32_t i = table_.find(key(slot, news.id), key_of());
  if (i < 0) i = enter(slot, news.id);
  ForeignRecord& r = record(i);
  Replica& owner = replica(slot);
  if (r.present) {
    owner.checksum -= mix(r.id, r.revision);
    --owner.present;
  }
  r.revision = news.revision;
  r.present = !news.removed;
  r.confirmed = true;
  if (!r.present) return;
  r.x_m = news.x_m;
  r.y_m = news.y_m;
  r.deviation_m = std::sqrt(std::max(news.covariance_m2[0], news.covariance_m2[3]));
  owner.checksum += mix(r.id, r.revision);
  ++owner.present;
}

void ReplicaStore::confirm(int slot, std::uint32_t id, std::uint32_t revision) {
  const std::int32_t i = table_.find(key(slot, id), key_of());
  if (i >= 0 && record(i).revision == revision) record(i).confirmed = true;
}

void ReplicaStore::cover(int slot, Range range) {
  Replica& owner = replica(slot);
  owner.had.add(range);
  owner.highest = std::max(owner.highest, range.last);
}

void ReplicaStore::doubt(int slot) {
  Replica& owner = replica(slot);
  owner.had.clear();
  for (std::int32_t i = owner.first; i >= 0; i = record(i).next) record(i).confirmed = false;
}

bool ReplicaStore::sweep_one(int slot, LandmarkRecord& removal) {
  for (std::int32_t i = replica(slot).first; i >= 0;) {
    const ForeignRecord r = record(i);
    const std::int32_t here = i;
    i = r.next;
    if (r.confirmed) continue;
    release(here);
    if (!r.present) continue;
    removal = LandmarkRecord{};
    removal.id = r.id;
    removal.revision = r.revision + 1;
    removal.removed = true;
    return true;
  }
  return false;
}

std::uint32_t ReplicaStore::unconfirmed(int slot) const {
  std::uint32_t count = 0;
  for (std::int32_t i = replica(slot).first; i >= 0; i = record(i).next) {
    if (record(i).present && !record(i).confirmed) ++count;
  }
  return count;
}

void ReplicaStore::purge_removals(int slot) {
  const Replica& owner = replica(slot);
  const auto had = owner.had.ranges();
  if (had.empty() || had.front().first > 1) return;
  const std::uint32_t covered = had.front().last;
  for (std::int32_t i = owner.first; i >= 0;) {
    const std::int32_t here = i;
    i = record(i).next;
    if (!record(here).present && record(here).revision <= covered) release(here);
  }
}

void ReplicaStore::forget_all(int slot) {
  while (replica(slot).first >= 0) release(replica(slot).first);
  replica(slot) = Replica{};
}

}  // namespace zenith::exchange
