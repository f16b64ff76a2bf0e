#pragma once
// Durations counted in bins whose width grows with the duration: every percentile is known to 1/8
// (12.5 %), the maximum exactly. 2.5 KiB, whatever is added.
//
// add() is wait-free, for one writer; other threads may read at any time and see each bin's recent
// count. Copies are plain: copy, then compute, when the figures must belong together.

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>

#include "platform/base/time.h"

namespace zenith {

class LatencyHistogram {
 public:
  LatencyHistogram() = default;
  LatencyHistogram(const LatencyHistogram& other) { copy_from(other); }
  LatencyHistogram& operator=(const LatencyHistogram& other) {
    if (this != &other) copy_from(other);
    return *this;
  }

  // Negative durations count as 0; those beyond kLongest in the last bin.
  void add(Duration duration);
  void merge(const LatencyHistogram& other);  // by the writer
  void clear();                               // by the writer

  std::uint64_t count() const;
  Duration longest() const { return {longest_ns_.load(std::memory_order_relaxed)}; }
  // The duration that `share` (0..1) of the counted ones do not exceed: the upper edge of its bin,
  // never above longest(). 0 when nothing was counted.
  Duration percentile(double share) const;

  // "1234 times, median 1.25 ms, 95 % 2.5 ms, 99.9 % 4 ms, longest 4.2 ms"
  std::string text() const;

  static constexpr int kOctaves = 34;
  static constexpr Duration kLongest = {std::int64_t{1} << (kOctaves + 2)};  // 69 s

 private:
  // Eight bins of 1 ns, then eight bins for each octave.
  static constexpr std::size_t kBins = 8 * kOctaves;
  static std::size_t bin_of(std::int64_t ns);
  static std::int64_t upper_edge_ns(std::size_t bin);
  void copy_from(const LatencyHistogram& other);

  std::array<std::atomic<std::uint64_t>, kBins> bins_ = {};
  std::atomic<std::int64_t> longest_ns_ = 0;
};

// "950 ns", "12.5 us", "3.21 ms", "1.5 s": three digits.
std::string duration_text(Duration duration);

}  // namespace zenith
