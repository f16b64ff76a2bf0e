#pragma once
// A queue between exactly two threads: one pushes, one pops. Neither ever waits, locks or
// allocates. Full: push() rejects and counts. Elements are plain data, stored in place, so the
// queue is as large as its elements: its owner allocates it at start.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace zenith {

template <typename T, std::size_t Capacity>
class SpscQueue {
  static_assert(std::is_trivially_copyable_v<T>, "plain data alone crosses threads");
  static_assert(Capacity > 0 && (Capacity & (Capacity - 1)) == 0, "a power of two");

 public:
  SpscQueue() = default;
  SpscQueue(const SpscQueue&) = delete;
  SpscQueue& operator=(const SpscQueue&) = delete;

  // The producer's call. False when full; the element is then not taken.
  bool push(const T& value) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail - seen_head_ == Capacity) {
      seen_head_ = head_.load(std::memory_order_acquire);
      if (tail - seen_head_ == Capacity) {
        // One writer: load and store are enough.
        rejected_.store(rejected_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
        return false;
      }
    }
    items_[tail & (Capacity - 1)] = value;
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

  // The consumer's call. False when empty.
  bool pop(T& out) {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == seen_tail_) {
      seen_tail_ = tail_.load(std::memory_order_acquire);
      if (head == seen_tail_) return false;
    }
    out = items_[head & (Capacity - 1)];
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  // Any thread; the value may be old when it arrives.
  std::size_t size() const {
    const std::size_t head = head_.load(std::memory_order_acquire);
    const std::size_t tail = tail_.load(std::memory_order_acquire);
    return tail - head < Capacity ? tail - head : Capacity;
  }
  std::uint64_t rejected() const { return rejected_.load(std::memory_order_relaxed); }
  static constexpr std::size_t capacity() { return Capacity; }

 private:
  static constexpr std::size_t kCacheLine = 64;

  // Indices grow without end and wrap with the type. Each side keeps its last sight of the other's.
  alignas(kCacheLine) std::atomic<std::size_t> tail_ = 0;
  std::size_t seen_head_ = 0;
  std::atomic<std::uint64_t> rejected_ = 0;
  alignas(kCacheLine) std::atomic<std::size_t> head_ = 0;
  std::size_t seen_tail_ = 0;
  alignas(kCacheLine) std::array<T, Capacity> items_ = {};
};

}  // namespace zenith
