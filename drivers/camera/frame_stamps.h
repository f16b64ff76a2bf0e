#pragma once
// Which capture stamps to believe.
//
// A stamp that its driver marks as CLOCK_MONOTONIC is believed when it lies at most kMaxAge before
// now, not after now, and after the stamp before it.
//
// An unmarked stamp (v4l2loopback, some vendors' drivers, libcamera) may be of any clock.
// v4l2loopback's are CLOCK_MONOTONIC unless its writer brought its own, and closer to the capture
// than our own reading of the clock, so they are believed too, but only within kMaxUnmarkedAge.
// The first one that fails shows that the clock is another one: all later ones of that stream are
// then replaced, for two clocks must not mix in one stream.
//
// A replaced stamp is `now`. All stamps rise strictly, also from stream to stream.

#include "platform/base/time.h"

namespace zenith {

class FrameStamps {
 public:
  static constexpr Duration kMaxAge = {10'000'000'000};
  static constexpr Duration kMaxUnmarkedAge = {1'000'000'000};

  struct Judged {
    Time stamp;
    bool replaced = false;
  };

  void new_stream() { other_clock_ = false; }

  // For each delivered frame, in order.
  Judged judge(Time stamp, bool marked_monotonic, Time now) {
    const Duration max_age = marked_monotonic ? kMaxAge : kMaxUnmarkedAge;
    // Compared without a difference, that a stamp from nowhere could overflow.
    const bool recent = stamp <= now && stamp >= now - max_age;
    if (!marked_monotonic && !recent) other_clock_ = true;
    const bool believed = recent && stamp > last_ && (marked_monotonic || !other_clock_);
    const Time after_last = last_ + Duration{1};
    last_ = believed ? stamp : (now > after_last ? now : after_last);
    return {last_, !believed};
  }

 private:
  Time last_;
  bool other_clock_ = false;
};

}  // namespace zenith
