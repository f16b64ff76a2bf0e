#pragma once
// Time as a strong type: nanoseconds of one monotonic clock. Never wall clock, never a bare number.

#include <compare>
#include <cstdint>

namespace zenith {

struct Duration {
  std::int64_t ns = 0;

  static constexpr Duration from_seconds(double s) {
    return {static_cast<std::int64_t>(s * 1e9 + (s >= 0.0 ? 0.5 : -0.5))};
  }
  constexpr double seconds() const { return static_cast<double>(ns) * 1e-9; }
  constexpr auto operator<=>(const Duration&) const = default;
};

// A point of CLOCK_MONOTONIC (on the robot) or of the recording's clock (in replay).
struct Time {
  std::int64_t ns = 0;

  constexpr auto operator<=>(const Time&) const = default;
};

constexpr Duration operator-(Time a, Time b) {
  return {a.ns - b.ns};
}
constexpr Time operator+(Time t, Duration d) {
  return {t.ns + d.ns};
}
constexpr Time operator-(Time t, Duration d) {
  return {t.ns - d.ns};
}
constexpr Duration operator+(Duration a, Duration b) {
  return {a.ns + b.ns};
}

}  // namespace zenith
