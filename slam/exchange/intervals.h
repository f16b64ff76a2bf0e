#pragma once
// A set of revisions as few ranges, sorted and apart. When it is full it forgets its smallest
// range, which costs least to ask for again; it never claims what was not added.
// Revisions are below 2^32 - 1.

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <span>

#include "slam/exchange/messages.h"

namespace zenith::exchange {

template <std::size_t Capacity>
class Intervals {
 public:
  void clear() { size_ = 0; }
  bool empty() const { return size_ == 0; }
  std::span<const Range> ranges() const { return std::span(ranges_).first(size_); }

  void add(Range added) {
    assert(added.first <= added.last && added.last < kToHead);
    // All ranges that overlap or touch the new one become one with it.
    const std::size_t from = first_ending_at(added.first == 0 ? 0 : added.first - 1);
    std::size_t to = from;
    for (; to < size_ && ranges_[to].first <= added.last + 1; ++to) {
      added.first = std::min(added.first, ranges_[to].first);
      added.last = std::max(added.last, ranges_[to].last);
    }
    replace(from, to, std::span(&added, 1));
    forget_smallest();
  }

  void remove(Range removed) {
    if (removed.last < removed.first) return;
    const std::size_t from = first_ending_at(removed.first);
    std::size_t to = from;
    std::array<Range, 2> left;
    std::size_t count = 0;
    for (; to < size_ && ranges_[to].first <= removed.last; ++to) {
      const Range r = ranges_[to];
      if (r.first < removed.first) left[count++] = {r.first, removed.first - 1};
      if (r.last > removed.last) left[count++] = {removed.last + 1, r.last};
    }
    replace(from, to, std::span(left).first(count));
    forget_smallest();
  }

  bool contains(std::uint32_t revision) const { return covers({revision, revision}); }
  bool covers(Range r) const {
    if (r.last < r.first) return true;
    const std::size_t i = first_ending_at(r.first);
    return i < size_ && ranges_[i].first <= r.first && ranges_[i].last >= r.last;
  }

  // How many of `within` are missing.
  std::uint32_t missing(Range within) const {
    std::uint32_t count = within.last - within.first + 1;
    for (const Range& r : ranges()) {
      const std::uint32_t first = std::max(r.first, within.first);
      const std::uint32_t last = std::min(r.last, within.last);
      if (first <= last) count -= last - first + 1;
    }
    return count;
  }

  // The first part of `within` that is missing; false when nothing is.
  bool first_gap(Range within, Range& gap) const {
    if (within.last < within.first) return false;
    const std::size_t i = first_ending_at(within.first);
    const bool inside = i < size_ && ranges_[i].first <= within.first;
    if (inside && ranges_[i].last >= within.last) return false;
    gap.first = inside ? ranges_[i].last + 1 : within.first;
    const std::size_t next = inside ? i + 1 : i;
    gap.last = next < size_ ? std::min(within.last, ranges_[next].first - 1) : within.last;
    return true;
  }

 private:
  // The first range whose end is not before `revision`.
  std::size_t first_ending_at(std::uint32_t revision) const {
    const auto all = ranges();
    const auto it = std::lower_bound(all.begin(), all.end(), revision,
                                     [](const Range& r, std::uint32_t x) { return r.last < x; });
    return static_cast<std::size_t>(it - all.begin());
  }

  // Ranges from .. to - 1 give way to `by`; there is room for one or two more than Capacity.
  void replace(std::size_t from, std::size_t to, std::span<const Range> by) {
    const auto begin = ranges_.begin();
    const std::size_t tail = size_ - to;
    const auto moved = [begin](std::size_t i) { return begin + static_cast<std::ptrdiff_t>(i); };
    if (from + by.size() > to) {
      std::copy_backward(moved(to), moved(size_), moved(from + by.size() + tail));
    } else {
      std::copy(moved(to), moved(size_), moved(from + by.size()));
    }
    std::copy(by.begin(), by.end(), moved(from));
    size_ = from + by.size() + tail;
  }

  void forget_smallest() {
    if (size_ <= Capacity) return;
    const auto length = [](const Range& r) { return r.last - r.first; };
    const auto all = std::span(ranges_).first(size_);
    const auto smallest =
        std::min_element(all.begin(), all.end(),
                         [&](const Range& a, const Range& b) { return length(a) < length(b); });
    const auto at = static_cast<std::size_t>(smallest - all.begin());
    replace(at, at + 1, {});
  }

  std::array<Range, Capacity + 1> ranges_ = {};
  std::size_t size_ = 0;
};

}  // namespace zenith::exchange
