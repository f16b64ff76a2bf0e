#pragma once
// Which records of the peers are here, by id and revision: one pool for all peers, a list of it for
// each. The records themselves are their taker's.
//
// A removed landmark is remembered as long as a late record could bring it back: until all
// revisions below its own are here, too.

#include <cstdint>
#include <span>

#include "platform/base/arena.h"
#include "slam/exchange/id_table.h"
#include "slam/exchange/intervals.h"
#include "slam/fleet/record.h"

namespace zenith::exchange {

inline constexpr std::size_t kMaxGaps = 64;

struct ForeignRecord {
  std::uint32_t id = 0;
  std::uint32_t revision = 0;
  std::int32_t next = -1;  // of the same replica
  std::int32_t previous = -1;
  std::uint8_t slot = 0;
  bool present = false;
  bool confirmed = false;  // told since all was asked for once more
  float x_m = 0.0F;
  float y_m = 0.0F;
  float deviation_m = 0.0F;  // the greater one of x and y
};

// One peer's map.
struct Replica {
  Intervals<kMaxGaps> had;
  std::uint32_t highest = 0;  // revision that is here or was covered
  std::uint32_t records = 0;  // in the pool
  std::uint32_t present = 0;
  std::uint64_t checksum = 0;
  std::int32_t first = -1;
};

class ReplicaStore {
 public:
  void layout(Arena& arena);
  void clear();

  Replica& replica(int slot) { return replicas_[static_cast<std::size_t>(slot)]; }
  const Replica& replica(int slot) const { return replicas_[static_cast<std::size_t>(slot)]; }
  const ForeignRecord* find(int slot, std::uint32_t id) const;
  // It is news: of a revision that was not here, and newer than what is known of its landmark.
  bool is_new(int slot, const LandmarkRecord& record) const;

  std::size_t room() const { return free_count_; }  // for landmarks that are not known yet
  // There must be room for a landmark that is not known yet.
  void apply(int slot, const LandmarkRecord& record);
  // A known record came again.
  void confirm(int slot, std::uint32_t id, std::uint32_t revision);
  void cover(int slot, Range range);

  // All is to be told once more; what is not, until it is here again, will be swept.
  void doubt(int slot);
  // One landmark that was not confirmed, taken out; false: none is left.
  bool sweep_one(int slot, LandmarkRecord& removal);
  std::uint32_t unconfirmed(int slot) const;
  // Removals that no late record can undo.
  void purge_removals(int slot);
  void forget_all(int slot);

 private:
  static std::uint64_t key(int slot, std::uint32_t id) {
    return static_cast<std::uint64_t>(slot) << 32u | id;
  }
  auto key_of() const {
    return [this](std::int32_t i) { return key(record(i).slot, record(i).id); };
  }
  ForeignRecord& record(std::int32_t i) { return records_[static_cast<std::size_t>(i)]; }
  const ForeignRecord& record(std::int32_t i) const {
    return records_[static_cast<std::size_t>(i)];
  }
  std::int32_t enter(int slot, std::uint32_t id);
  void release(std::int32_t i);

  std::span<Replica> replicas_;
  std::span<ForeignRecord> records_;
  std::span<std::int32_t> free_;  // a stack
  std::size_t free_count_ = 0;
  IdTable table_;
};

}  // namespace zenith::exchange
