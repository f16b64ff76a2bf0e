#pragma once
// The latest value of a struct, from one writer to one reader; both are wait-free, so either may be
// the realtime thread. Written and read in place: suits large values. Values that nobody fetched
// are overwritten by newer ones.

#include <array>
#include <atomic>

namespace zenith {

template <typename T>
class TripleBuffer {
 public:
  TripleBuffer() = default;
  TripleBuffer(const TripleBuffer&) = delete;
  TripleBuffer& operator=(const TripleBuffer&) = delete;

  // The writer's place. It holds some older value, not necessarily the last one: write it whole.
  // Valid until publish().
  T& back() { return slots_[back_]; }
  void publish() { back_ = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kIndex; }

  // The reader's call: true when a newer value is in front() than before.
  bool fetch() {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return true;
  }
  // The value of the last fetch(), a default one before the first. Valid until the next fetch().
  const T& front() const { return slots_[front_]; }

 private:
  static constexpr unsigned kFresh = 4;
  static constexpr unsigned kIndex = 3;

  std::array<T, 3> slots_ = {};
  alignas(64) unsigned back_ = 0;
  alignas(64) std::atomic<unsigned> middle_ = 1;
  alignas(64) unsigned front_ = 2;
};

}  // namespace zenith
