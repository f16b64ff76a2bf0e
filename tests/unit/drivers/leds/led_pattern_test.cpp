#include "drivers/leds/led_pattern.h"

#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace zenith {
namespace {

constexpr RobotLight kAll[] = {RobotLight::kStarting, RobotLight::kMapping, RobotLight::kMerged,
                               RobotLight::kDegraded, RobotLight::kFault,   RobotLight::kStopped};
constexpr int kSteps = 20;  // two seconds: a multiple of every rhythm's length

// As a person sees one LED: "#" lit, "." dark.
std::string seen(RobotLight light, LedMask led, int first_step = 0) {
  std::string text;
  for (int i = 0; i < kSteps; ++i) {
    const Duration since = {(first_step + i) * kLedStep.ns};
    text += (led_pattern(light, since) & led) != 0 ? '#' : '.';
  }
  return text;
}

// The table of docs/lights.md.
TEST(LedPattern, IsTheTableOfTheReadme) {
  EXPECT_EQ(seen(RobotLight::kStarting, kStatusLed), "##########..........");
  EXPECT_EQ(seen(RobotLight::kMapping, kStatusLed), "#...................");
  EXPECT_EQ(seen(RobotLight::kMerged, kStatusLed), "#..#................");
  EXPECT_EQ(seen(RobotLight::kDegraded, kStatusLed), "#..#..#.............");
  EXPECT_EQ(seen(RobotLight::kFault, kStatusLed), "#.#.#.#.#.#.#.#.#.#.");
  EXPECT_EQ(seen(RobotLight::kStopped, kStatusLed), "....................");
}

TEST(LedPattern, TheOtherLedsRepeatWhatConcernsThem) {
  const std::string dark(kSteps, '.');
  for (const RobotLight light : kAll) {
    SCOPED_TRACE(static_cast<int>(light));
    const std::string status = seen(light, kStatusLed);
    const bool peer = light == RobotLight::kMerged;
    const bool fault = light == RobotLight::kDegraded || light == RobotLight::kFault;
    EXPECT_EQ(seen(light, kPeerLed), peer ? status : dark);
    EXPECT_EQ(seen(light, kFaultLed), fault ? status : dark);
  }
}

// A person looks at any moment: no two states may look alike, however the rhythm is shifted.
TEST(LedPattern, OneLedTellsAllStatesApartFromAnyMomentOn) {
  std::map<std::string, RobotLight> known;
  for (const RobotLight light : kAll) {
    for (int shift = 0; shift < kSteps; ++shift) {
      const auto [entry, fresh] = known.emplace(seen(light, kStatusLed, shift), light);
      if (fresh) continue;
      EXPECT_EQ(entry->second, light);
    }
  }
}

TEST(LedPattern, NoStateIsSteadyLight) {
  for (const RobotLight light : kAll) {
    EXPECT_NE(seen(light, kStatusLed).find('.'), std::string::npos);
  }
}

TEST(LedPattern, StepsBeginWhereTheySayAndTimeBeforeTheChangeIsTheChange) {
  EXPECT_EQ(led_pattern(RobotLight::kMapping, {kLedStep.ns - 1}), kStatusLed);
  EXPECT_EQ(led_pattern(RobotLight::kMapping, kLedStep), 0);
  EXPECT_EQ(led_pattern(RobotLight::kMapping, {-1}), kStatusLed);
  EXPECT_EQ(led_pattern(RobotLight::kMapping, {INT64_MIN}), kStatusLed);
}

TEST(LedPattern, RepeatsForEver) {
  const int days = 1'000'000 * kSteps;
  for (const RobotLight light : kAll) {
    EXPECT_EQ(seen(light, kStatusLed, days), seen(light, kStatusLed));
  }
}

}  // namespace
}  // namespace zenith
