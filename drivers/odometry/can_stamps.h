#pragma once
// The kernel's reception stamps (CLOCK_REALTIME) as CLOCK_MONOTONIC.
//
//   monotonic stamp = stamp - (realtime - monotonic), both clocks read at one moment, for each
//   frame
//
// A step of the wall clock between a frame's reception and that moment shifts the result by as
// much. So a stamp is believed only when it lies after the moment at which the queue was last seen
// empty, less kMaxHandover, and not after now, but for kSlack; otherwise it is replaced and
// counted: by `now`, or, when it is too old, by the moment of the empty queue. (Were that `now`,
// too, the stamps of the frames behind it would lie before it, and their travel seem to have come
// in no time.) Stamps never go back.

#include <algorithm>
#include <cstdint>
#include <optional>

#include "platform/base/time.h"

namespace zenith {

class CanStamps {
 public:
  // Two clocks are read at one moment as exactly as this.
  static constexpr Duration kSlack = {1'000'000};
  // From the stamp to the queue: on a realtime kernel the thread in between may have to wait for
  // the one that reads. Wall clocks step by more; smaller errors are slewed.
  static constexpr Duration kMaxHandover = {20'000'000};

  struct Judged {
    Time stamp;
    bool replaced = false;
  };

  // The queue was empty at `now`; also right after open().
  void seen_empty(Time now) { empty_at_ = now; }

  // For each delivered frame, in order of arrival.
  Judged judge(std::optional<std::int64_t> realtime_ns, Time now, std::int64_t now_realtime_ns) {
    Judged judged = {now, true};
    if (realtime_ns) {
      // A stamp from nowhere must not overflow: ages are compared, not times.
      const std::int64_t oldest_ns = (now - empty_at_).ns + kMaxHandover.ns;
      const std::int64_t age_ns = saturating_difference(now_realtime_ns, *realtime_ns);
      if (age_ns >= -kSlack.ns && age_ns <= oldest_ns) {
        judged = {std::min(now, now - Duration{age_ns}), false};
      } else if (age_ns > oldest_ns) {
        judged.stamp = std::min(now, std::max(empty_at_, last_ + Duration{1}));
      }
    }
    last_ = judged.stamp = std::max(judged.stamp, last_);
    return judged;
  }

 private:
  static std::int64_t saturating_difference(std::int64_t a, std::int64_t b) {
    std::int64_t difference = 0;
    if (!__builtin_sub_overflow(a, b, &difference)) return difference;
    return a < b ? INT64_MIN : INT64_MAX;
  }

  Time empty_at_ = {INT64_MIN / 4};
  Time last_ = {INT64_MIN / 4};
};

}  // namespace zenith
