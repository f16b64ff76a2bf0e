#include "tests/hil/programs/rhythm.h"

#include <gtest/gtest.h>

#include "drivers/leds/led_pattern.h"

namespace zenith::hil {
namespace {

constexpr Time kStart = {1'000'000'000'000};

// Changes of one LED that shows `light` for `seconds`, as one who looks every 10 ms sees them, when
// the daemon sets it every `every`.
std::vector<LightChange> shown(RobotLight light, LedMask led, double seconds, Duration every,
                               Duration phase = {}) {
  std::vector<LightChange> changes;
  const Duration total = Duration::from_seconds(seconds);
  for (Duration t; t < total; t = t + Duration{10'000'000}) {
    const Duration set = {t.ns / every.ns * every.ns};
    const bool lit = (led_pattern(light, set + phase) & led) != 0;
    if (changes.empty() || changes.back().lit != lit) changes.push_back({kStart + t, lit});
  }
  return changes;
}

std::string read(RobotLight light, LedMask led, Duration every, Duration phase = {}) {
  constexpr double kSeconds = 5.0;
  return read_rhythm(shown(light, led, kSeconds, every, phase),
                     kStart + Duration::from_seconds(kSeconds));
}

TEST(Rhythm, TellsTheStatesApart) {
  for (int phase_ms = 0; phase_ms < 2000; phase_ms += 70) {
    for (const int every_ms : {20, 50, 80}) {
      SCOPED_TRACE(std::to_string(phase_ms) + " ms, set every " + std::to_string(every_ms) + " ms");
      const Duration phase = {phase_ms * std::int64_t{1'000'000}};
      const Duration every = {every_ms * std::int64_t{1'000'000}};
      EXPECT_EQ(read(RobotLight::kStarting, kStatusLed, every, phase), "starting");
      EXPECT_EQ(read(RobotLight::kMapping, kStatusLed, every, phase), "mapping");
      EXPECT_EQ(read(RobotLight::kMerged, kStatusLed, every, phase), "merged");
      EXPECT_EQ(read(RobotLight::kMerged, kPeerLed, every, phase), "merged");
      EXPECT_EQ(read(RobotLight::kDegraded, kFaultLed, every, phase), "degraded");
      EXPECT_EQ(read(RobotLight::kFault, kStatusLed, every, phase), "fault");
      EXPECT_EQ(read(RobotLight::kMapping, kPeerLed, every, phase), "dark");
    }
  }
}

TEST(Rhythm, ALightThatHangsIsSteadyOrDark) {
  const Time now = kStart + Duration::from_seconds(5.0);
  EXPECT_EQ(read_rhythm({{kStart, true}}, now), "steady");
  EXPECT_EQ(read_rhythm({{kStart, false}}, now), "dark");
}

TEST(Rhythm, IsUnclearAsLongAsTooLittleWasSeen) {
  EXPECT_EQ(read_rhythm({}, kStart), "unclear");
  EXPECT_EQ(read_rhythm({{kStart, true}}, kStart + Duration::from_seconds(4.0)), "unclear");
}

}  // namespace
}  // namespace zenith::hil
