#include "platform/linux/latency_histogram.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace zenith {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;

// There is one writer: load and store are enough, and no bus is locked.
void increase(std::atomic<std::uint64_t>& counter, std::uint64_t by) {
  counter.store(counter.load(kRelaxed) + by, kRelaxed);
}

}  // namespace

// Below 8 ns the bin is the number itself. Above, the three bits after the leading one choose among
// the octave's eight bins.
std::size_t LatencyHistogram::bin_of(std::int64_t ns) {
  const auto value = static_cast<std::uint64_t>(ns);
  if (value < 8) return static_cast<std::size_t>(value);
  const auto octave = static_cast<unsigned>(std::bit_width(value)) - 3;  // 1: 8..15
  const std::size_t bin = 8 * std::size_t{octave} + ((value >> (octave - 1)) & 7U);
  return std::min(bin, kBins - 1);
}

std::int64_t LatencyHistogram::upper_edge_ns(std::size_t bin) {
  if (bin < 8) return static_cast<std::int64_t>(bin);
  const std::size_t octave = bin / 8;
  const auto first = static_cast<std::int64_t>(8 + bin % 8);
  return ((first + 1) << (octave - 1)) - 1;
}

void LatencyHistogram::add(Duration duration) {
  const std::int64_t ns = std::max<std::int64_t>(duration.ns, 0);
  increase(bins_[bin_of(ns)], 1);
  if (ns > longest_ns_.load(kRelaxed)) longest_ns_.store(ns, kRelaxed);
}

void LatencyHistogram::merge(const LatencyHistogram& other) {
  for (std::size_t i = 0; i < kBins; ++i) increase(bins_[i], other.bins_[i].load(kRelaxed));
  if (other.longest() > longest()) longest_ns_.store(other.longest().ns, kRelaxed);
}

void LatencyHistogram::clear() {
  for (auto& bin : bins_) bin.store(0, kRelaxed);
  longest_ns_.store(0, kRelaxed);
}

void LatencyHistogram::copy_from(const LatencyHistogram& other) {
  for (std::size_t i = 0; i < kBins; ++i) bins_[i].store(other.bins_[i].load(kRelaxed), kRelaxed);
  longest_ns_.store(other.longest().ns, kRelaxed);
}

std::uint64_t LatencyHistogram::count() const {
  std::uint64_t sum = 0;
  for (const auto& bin : bins_) sum += bin.load(kRelaxed);
  return sum;
}

Duration LatencyHistogram::percentile(double share) const {
  const double wanted = std::ceil(std::clamp(share, 0.0, 1.0) * static_cast<double>(count()));
  double seen = 0.0;
  for (std::size_t i = 0; i < kBins; ++i) {
    seen += static_cast<double>(bins_[i].load(kRelaxed));
    if (seen == 0.0 || seen < wanted) continue;
    if (i == kBins - 1) return longest();
    return std::min(Duration{upper_edge_ns(i)}, longest());
  }
  return {};
}

std::string LatencyHistogram::text() const {
  const LatencyHistogram copy(*this);
  return std::to_string(copy.count()) + " times, median " + duration_text(copy.percentile(0.5)) +
         ", 95 % " + duration_text(copy.percentile(0.95)) + ", 99.9 % " +
         duration_text(copy.percentile(0.999)) + ", longest " + duration_text(copy.longest());
}

std::string duration_text(Duration duration) {
  static constexpr const char* kUnits[] = {"ns", "us", "ms", "s"};
  auto value = static_cast<double>(duration.ns);
  std::size_t unit = 0;
  while (std::abs(value) >= 999.5 && unit + 1 < std::size(kUnits)) {
    value /= 1000.0;
    ++unit;
  }
  char text[32];
  // %g would write 1e+03 for whole thousands of seconds.
  std::snprintf(text, sizeof(text), std::abs(value) >= 999.5 ? "%.0f %s" : "%.3g %s", value,
                kUnits[unit]);
  return text;
}

}  // namespace zenith
