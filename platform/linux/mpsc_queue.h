#pragma once
// A queue from any number of threads to one. push() never waits, locks or allocates; full, it
// rejects. Elements are plain data, stored in place.
//
// D. Vyukov's bounded queue: each cell carries the number of the turn it is ready for. A producer
// that is set aside between taking its cell and filling it holds back later elements from pop(),
// but no other producer.

#include <array>
#include <atomic>
#include <cstddef>
#include <type_traits>

namespace zenith {

template <typename T, std::size_t Capacity>
class MpscQueue {
  static_assert(std::is_trivially_copyable_v<T>, "plain data alone crosses threads");
  static_assert(Capacity > 1 && (Capacity & (Capacity - 1)) == 0, "a power of two");

 public:
  MpscQueue() {
    for (std::size_t i = 0; i < Capacity; ++i) {
      cells_[i].turn.store(i, std::memory_order_relaxed);
    }
  }
  MpscQueue(const MpscQueue&) = delete;
  MpscQueue& operator=(const MpscQueue&) = delete;

  // False when full; the element is then not taken. Any thread.
  bool push(const T& value) {
    std::size_t tail = tail_.load(std::memory_order_relaxed);
    while (true) {
      Cell& cell = cells_[tail & (Capacity - 1)];
      const std::size_t turn = cell.turn.load(std::memory_order_acquire);
      if (turn == tail) {
        if (!tail_.compare_exchange_weak(tail, tail + 1, std::memory_order_relaxed)) continue;
        cell.value = value;
        cell.turn.store(tail + 1, std::memory_order_release);
        return true;
      }
      // The cell's turn is behind: it still holds the element of one round ago.
      if (static_cast<std::ptrdiff_t>(turn - tail) < 0) return false;
      tail = tail_.load(std::memory_order_relaxed);
    }
  }

  // The one consumer's call. False when empty.
  bool pop(T& out) {
    Cell& cell = cells_[head_ & (Capacity - 1)];
    if (cell.turn.load(std::memory_order_acquire) != head_ + 1) return false;
    out = cell.value;
    cell.turn.store(head_ + Capacity, std::memory_order_release);
    ++head_;
    return true;
  }

  static constexpr std::size_t capacity() { return Capacity; }

 private:
  struct Cell {
    std::atomic<std::size_t> turn = 0;
    T value = {};
  };

  alignas(64) std::atomic<std::size_t> tail_ = 0;
  alignas(64) std::size_t head_ = 0;
  alignas(64) std::array<Cell, Capacity> cells_ = {};
};

}  // namespace zenith
