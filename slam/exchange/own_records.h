#pragma once
// The own map as it was told, and what is still to be told of it.
//
// Each landmark has what was told of it last, under its revision, and the newest state when that
// differs. A change of what waits already replaces it. Landmarks that came and went untold are
// never told of. A landmark that was just told of rests for a while before it is told of again.
// Removals stay, so that they can be asked for, until their room is needed: then the oldest one
// is forgotten. A peer that never heard of it sees that the checksum differs, and asks for all.

#include <cstdint>
#include <span>

#include "platform/base/arena.h"
#include "platform/base/time.h"
#include "slam/exchange/id_table.h"
#include "slam/exchange/record_code.h"
#include "slam/exchange/records_section.h"

namespace zenith::exchange {

class OwnRecords {
 public:
  void layout(Arena& arena);
  void clear();
  void set_rest(Duration rest) { rest_ = rest; }

  enum class Outcome { kTaken, kUntellable, kFull };
  Outcome set(const LandmarkRecord& record);

  std::uint32_t head() const { return head_; }  // highest revision that was told
  std::uint32_t present() const { return present_; }
  std::uint64_t checksum() const { return checksum_; }
  std::uint64_t forgotten() const { return forgotten_; }  // removals

  // What has rested enough waits again, if there is something to tell.
  void advance(Time now);

  // What waits: landmarks that nobody knows yet and removals, then changes.
  enum class Queue { kNew, kChanged };
  std::size_t waiting(Queue queue) const { return rings_[index(queue)].count; }
  std::size_t waiting_bytes(Queue queue) const { return rings_[index(queue)].bytes; }
  // The next one's bytes; 0: none.
  std::size_t next_bytes(Queue queue) const;
  // Tells the next one under revision head() + 1: appends it to `out`, where it must fit.
  void tell_next(Time now, Queue queue, RecordsWriter& out);
  // All that waits gets its revisions as if it had been sent: for when there is nobody to hear it.
  // Whoever comes asks for it.
  void tell_nobody();

  // Appends what was told in `range`, by rising revision, as far as it fits. Returns the last
  // revision that is covered by what was written; range.first - 1 when nothing is.
  std::uint32_t write_told(Range range, RecordsWriter& out) const;

 private:
  struct Entry {
    std::uint32_t id = 0;
    std::uint32_t revision = 0;  // under which `told` was told; 0: never
    bool told_removed = false;
    bool newest_removed = false;
    bool waits = false;      // `newest` is to be told
    std::int8_t queue = -1;  // the ring where it stands, perhaps without waiting any more
    Time told_at;
    EncodedRecord told;
    EncodedRecord newest;
  };
  struct Told {  // entry's revision differs: it was told again later
    std::uint32_t revision = 0;
    std::int32_t entry = 0;
  };
  // First in, first out; an entry stands in one of them at most once.
  struct Ring {
    std::span<std::int32_t> slots;
    std::size_t first = 0;
    std::size_t count = 0;
    std::size_t bytes = 0;  // of those that wait
  };

  static std::size_t index(Queue queue) { return static_cast<std::size_t>(queue); }
  static std::uint32_t told_present(const Entry& e) {
    return e.revision != 0 && !e.told_removed ? 1 : 0;
  }
  Entry& entry(std::int32_t i) { return entries_[static_cast<std::size_t>(i)]; }
  const Entry& entry(std::int32_t i) const { return entries_[static_cast<std::size_t>(i)]; }
  auto id_of() const {
    return [this](std::int32_t i) { return std::uint64_t{entry(i).id}; };
  }
  std::int32_t enter(std::uint32_t id);
  void release(std::int32_t i);
  bool forget_a_removal();
  void push(std::size_t ring, std::int32_t i);
  void wait(std::int32_t i);
  void wait_no_more(std::int32_t i);
  void trim(Ring& ring);
  std::int32_t pop(Ring& ring);
  void tell_front(Ring& ring);
  void note_told(std::int32_t i);

  std::span<Entry> entries_;
  std::span<std::int32_t> free_;  // a stack
  std::size_t free_count_ = 0;
  IdTable table_;
  static constexpr std::size_t kResting = 2;
  std::array<Ring, 3> rings_;  // the two queues, and what was told of lately
  Duration rest_;
  std::span<Told> told_;  // by rising revision
  std::size_t told_count_ = 0;
  std::uint32_t head_ = 0;
  std::uint32_t present_ = 0;
  std::uint64_t checksum_ = 0;
  std::uint64_t forgotten_ = 0;
};

}  // namespace zenith::exchange
