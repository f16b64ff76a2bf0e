#pragma once
// A token bucket that keeps a cap in any window of one second, wherever it begins: what lies in
// the bucket and what flows into it during a second are together not more than the cap.

#include <algorithm>
#include <cstdint>

#include "platform/base/time.h"

namespace zenith::exchange {

class Budget {
 public:
  // Bytes a second. `largest` is the greatest cost that must be possible at once; it gets at most
  // half of the cap. Full at first; later calls, with the same cap, keep the promise across them.
  void configure(std::uint32_t cap, std::uint32_t largest) {
    const std::uint32_t before = burst_;
    burst_ = std::min(std::max(cap / 32, largest), cap / 2);
    rate_ = cap - burst_;
    if (before == 0) {
      tokens_ = full();
    } else {
      const std::int64_t change = std::int64_t{burst_} - std::int64_t{before};
      tokens_ = std::min(tokens_, full()) - (change < 0 ? -change : change) * kSecond;
    }
  }

  // Keeps the rate on average alone. Later calls change what flows, not what is there.
  void configure_average(std::uint32_t rate, std::uint32_t burst) {
    if (burst_ == 0) tokens_ = std::int64_t{burst} * kSecond;
    rate_ = rate;
    burst_ = burst;
  }

  std::uint32_t burst() const { return burst_; }

  // What may be spent at `now`, in bytes.
  std::uint32_t available(Time now) {
    refill(now);
    return static_cast<std::uint32_t>(std::max<std::int64_t>(tokens_, 0) / kSecond);
  }
  bool spend(Time now, std::uint64_t bytes) {
    if (bytes > available(now)) return false;
    tokens_ -= static_cast<std::int64_t>(bytes) * kSecond;
    return true;
  }
  // When so many bytes will be there. Never, which is in an hour, when they are more than burst().
  Time when(Time now, std::uint64_t bytes) const {
    if (bytes > burst_ || rate_ == 0) return now + Duration::from_seconds(3600.0);
    const auto wanted = static_cast<std::int64_t>(bytes) * kSecond;
    if (tokens_ >= wanted) return now;
    return std::max(now, Time{refilled_.ns + (wanted - tokens_ + rate_ - 1) / rate_});
  }

 private:
  static constexpr std::int64_t kSecond = 1'000'000'000;  // tokens are bytes * 1e-9
  std::int64_t full() const { return std::int64_t{burst_} * kSecond; }

  void refill(Time now) {
    const std::int64_t passed = std::clamp<std::int64_t>(now.ns - refilled_.ns, 0, kSecond);
    if (now > refilled_) refilled_ = now;
    tokens_ = std::min(full(), tokens_ + passed * std::int64_t{rate_});
  }

  std::uint32_t burst_ = 0;
  std::uint32_t rate_ = 0;
  std::int64_t tokens_ = 0;
  Time refilled_;
};

}  // namespace zenith::exchange
