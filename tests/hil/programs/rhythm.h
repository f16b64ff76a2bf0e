#pragma once
// The robot's state from one of its lights, as a person reads it: docs/lights.md. Written
// against that table, not with the code that makes the rhythms.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "platform/base/time.h"

namespace zenith::hil {

struct LightChange {
  Time at;
  bool lit = false;
};

inline constexpr Duration kRhythm = {2'000'000'000};   // the longest one
inline constexpr Duration kBetween = {900'000'000};    // a longer gap parts groups of flashes
inline constexpr Duration kLongFlash = {700'000'000};  // of "starting"; others last 0.1 s
inline constexpr Duration kWatched = {4'500'000'000};  // two rhythms and some

// From the changes of a light, the newest last, up to `now`. The first one is its state when
// watching began. "starting", "mapping", "merged", "degraded", "fault", "dark", "steady", or
// "unclear" as long as too little was seen.
inline std::string read_rhythm(const std::vector<LightChange>& changes, Time now) {
  if (changes.empty() || now - changes.front().at < kWatched) return "unclear";
  const Time since = now - kWatched;
  if (changes.back().at < since) return changes.back().lit ? "steady" : "dark";
  std::vector<Time> flashes;  // their beginnings
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const LightChange& change = changes[i];
    const Time end = i + 1 < changes.size() ? changes[i + 1].at : now;
    if (!change.lit || end < since) continue;
    if (end - change.at > kLongFlash && change.at > since) return "starting";
    if (change.at > since) flashes.push_back(change.at);
  }
  // Five a second; half of them may have been missed.
  if (flashes.size() >= 12) return "fault";
  // The newest group that has gaps on both sides.
  std::size_t count = 0;
  std::string newest = "unclear";
  for (std::size_t i = 0; i < flashes.size(); ++i) {
    const Time before = i == 0 ? since : flashes[i - 1];
    if (flashes[i] - before > kBetween) count = 0;
    const bool begun = count > 0 || flashes[i] - before > kBetween;
    if (!begun) continue;
    ++count;
    const Time after = i + 1 < flashes.size() ? flashes[i + 1] : now;
    if (after - flashes[i] <= kBetween) continue;
    constexpr const char* kStates[] = {"mapping", "merged", "degraded"};
    newest = count <= 3 ? kStates[count - 1] : "unclear";
  }
  return newest;
}

}  // namespace zenith::hil
