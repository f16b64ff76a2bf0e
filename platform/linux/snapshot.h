#pragma once
// The latest value of a plain struct, from one writer to any number of readers.
//
// write() is wait-free: for the realtime thread. read() tries again while it is overtaken, so a
// reader of higher priority than the writer could spin on a writer that it has pushed aside: for
// values that the realtime thread *reads*, take TripleBuffer.
//
// A seqlock whose words are atomics: a word of a newer value, once seen (acquire), makes the newer
// sequence number visible too, so a mixture of two values is always noticed. No fences, no data
// race.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace zenith {

template <typename T>
class Snapshot {
  static_assert(std::is_trivially_copyable_v<T>, "plain data alone crosses threads");

 public:
  Snapshot() = default;
  Snapshot(const Snapshot&) = delete;
  Snapshot& operator=(const Snapshot&) = delete;

  // One thread only.
  void write(const T& value) {
    const std::uint64_t sequence = sequence_.load(std::memory_order_relaxed);
    sequence_.store(sequence + 1, std::memory_order_relaxed);  // odd: being written
    for (std::size_t i = 0; i < kWords; ++i) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes(value) + i * kWordBytes, word_bytes(i));
      words_[i].store(word, std::memory_order_release);
    }
    sequence_.store(sequence + 2, std::memory_order_release);
  }

  // False, and `out` untouched, as long as nothing was written.
  bool read(T& out) const {
    std::array<std::uint64_t, kWords> copy;
    std::uint64_t before = 0;
    do {
      before = sequence_.load(std::memory_order_acquire);
      if (before == 0) return false;
      for (std::size_t i = 0; i < kWords; ++i) {
        copy[i] = words_[i].load(std::memory_order_acquire);
      }
    } while ((before & 1U) != 0 || sequence_.load(std::memory_order_relaxed) != before);
    std::memcpy(static_cast<void*>(&out), copy.data(), sizeof(T));
    return true;
  }

  // How many values were written; tells a reader whether there is a new one.
  std::uint64_t version() const { return sequence_.load(std::memory_order_acquire) / 2; }

 private:
  static constexpr std::size_t kWordBytes = sizeof(std::uint64_t);
  static constexpr std::size_t kWords = (sizeof(T) + kWordBytes - 1) / kWordBytes;

  static const unsigned char* bytes(const T& value) {
    return reinterpret_cast<const unsigned char*>(&value);
  }
  static constexpr std::size_t word_bytes(std::size_t i) {
    return i + 1 < kWords ? kWordBytes : sizeof(T) - i * kWordBytes;
  }

  std::atomic<std::uint64_t> sequence_ = 0;
  std::array<std::atomic<std::uint64_t>, kWords> words_ = {};
};

}  // namespace zenith
