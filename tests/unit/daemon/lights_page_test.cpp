// docs/lights.md says what the program does.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "drivers/leds/led_pattern.h"
#include "platform/daemon/health.h"
#include "tests/support/markdown.h"

namespace zenith {
namespace {

using testing::Contains;
using testing::Key;
using testing::SizeIs;
using testing::StartsWith;

constexpr Time kNow = {100'000'000'000};
constexpr std::array kLights = {RobotLight::kStarting, RobotLight::kMapping, RobotLight::kMerged,
                                RobotLight::kDegraded, RobotLight::kFault,   RobotLight::kStopped};

Page lights_page() {
  return read_page(std::filesystem::path(ZENITH_SOURCE_DIR) / "docs" / "lights.md");
}

// Rows by their first cell: of the table with that many columns.
std::map<std::string, std::vector<std::string>> rows(std::size_t columns) {
  std::map<std::string, std::vector<std::string>> by_name;
  for (const auto& row : lights_page().rows) {
    if (row.size() == columns) by_name[row[0]] = row;
  }
  return by_name;
}

// The rhythm of one LED in two seconds; its beginning where it repeats sooner.
std::string rhythm(RobotLight light, LedMask led) {
  std::string text;
  for (int step = 0; step < 20; ++step) {
    const LedMask lit = led_pattern(light, {step * kLedStep.ns});
    text += (lit & led) != 0 ? '#' : '.';
  }
  return text;
}

TEST(LightsPage, HasTheRhythmOfEachState) {
  const auto table = rows(6);
  for (const RobotLight light : kLights) {
    ASSERT_THAT(table, Contains(Key(light_name(light))));
    const auto& row = table.at(light_name(light));
    std::string said;
    while (said.size() < 20) said += row[1].substr(1, row[1].size() - 2);
    EXPECT_EQ(said, rhythm(light, kStatusLed)) << light_name(light);
    for (const auto& [cell, led] : {std::pair{4, kPeerLed}, std::pair{5, kFaultLed}}) {
      const bool lit = rhythm(light, led).find('#') != std::string::npos;
      EXPECT_EQ(row[static_cast<std::size_t>(cell)], lit ? "yes" : "") << light_name(light);
    }
  }
  EXPECT_THAT(table, SizeIs(kLights.size() + 1)) << "a state that the program does not have";
}

// All that judge_health() can say.
std::set<std::string> reasons() {
  std::set<std::string> all = {kMapNotKept};
  for (int bits = 0; bits < 128; ++bits) {
    const auto is = [bits](int bit) { return (bits >> bit & 1) != 0; };
    PerceptionReport report;
    report.has_pose = true;
    report.camera_up = is(0);
    report.can_up = is(1);
    report.bus_off = is(2);
    report.sheds = is(3);
    report.last_frame = is(4) ? kNow : Time{};
    report.last_wheels = is(5) ? kNow : Time{};
    report.camera_frozen = is(6);
    for (const VerdictState state : {VerdictState::kDoubtful, VerdictState::kWrong}) {
      PerceptionReport judged = report;
      judged.verdict.reasons.push_back({SetupCode::kYawWrong, state, 5.0, 0.0, true});
      const Health health = judge_health(judged, {10, 0}, {}, kNow);
      if (!health.reason.empty()) all.insert(health.reason);
    }
    for (const WheelFaultKind kind : {WheelFaultKind::kNonsense, WheelFaultKind::kLeftStands}) {
      PerceptionReport faulty = report;
      faulty.wheel_fault.kind = kind;
      const Health health = judge_health(faulty, {10, 0}, {}, kNow);
      if (!health.reason.empty()) all.insert(health.reason);
    }
    for (const std::uint64_t missed : {0, 9}) {
      const Health health = judge_health(report, {10, missed}, {}, kNow);
      if (!health.reason.empty()) all.insert(health.reason);
    }
  }
  return all;
}

TEST(LightsPage, HasEachReason) {
  std::set<std::string> said;
  for (const auto& [name, row] : rows(2)) {
    if (name != "reason" && !name.empty()) said.insert(name);
  }
  EXPECT_EQ(said, reasons());
}

TEST(LightsPage, SaysHowLongAFaultTakes) {
  EXPECT_EQ(kFaultAfter.ns, 15'000'000'000);
  EXPECT_EQ(kDegradedAfter.ns, 1'500'000'000);
  const auto meanings = rows(3);
  EXPECT_THAT(meanings, Contains(Key("fault")));
  EXPECT_NE(meanings.at("fault")[1].find("15 s"), std::string::npos);
  EXPECT_NE(rows(2).at("no frames from the camera")[1].find("1.5 s"), std::string::npos);
}

}  // namespace
}  // namespace zenith
