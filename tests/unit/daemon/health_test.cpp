#include "platform/daemon/health.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace zenith {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr Time kStart = {100 * kSecond};

// A robot that maps well at `now`.
PerceptionReport mapping(Time now) {
  PerceptionReport report;
  report.has_pose = true;
  report.camera_up = report.can_up = true;
  report.last_frame = report.last_wheels = now;
  return report;
}

PeerReport peer(int slot, AlignmentState state) {
  PeerReport report;
  report.peer = slot;
  report.state = state;
  return report;
}

Health at(const PerceptionReport& report, Time now, const Lately& lately = {}) {
  return judge_health(report, lately, kStart, now);
}

TEST(Health, StartsAndWaitsBeforeItIsAFault) {
  PerceptionReport nothing;
  EXPECT_EQ(at(nothing, kStart).light, RobotLight::kStarting);
  EXPECT_EQ(at(nothing, kStart).reason, "");
  const Health waits = at(nothing, kStart + Duration{5 * kSecond});
  EXPECT_EQ(waits.light, RobotLight::kStarting);
  EXPECT_EQ(waits.reason, "no camera");
  EXPECT_EQ(at(nothing, kStart + kFaultAfter + Duration{1}).light, RobotLight::kFault);
}

TEST(Health, MapsAndMerges) {
  const Time now = kStart + Duration{60 * kSecond};
  PerceptionReport report = mapping(now);
  EXPECT_EQ(at(report, now).light, RobotLight::kMapping);
  report.peers.push_back(peer(2, AlignmentState::kCandidate));
  EXPECT_EQ(at(report, now).light, RobotLight::kMapping);
  report.peers.push_back(peer(3, AlignmentState::kMerged));
  EXPECT_EQ(at(report, now).light, RobotLight::kMerged);
  EXPECT_THAT(status_text(report, at(report, now)), HasSubstr("merged with 1 peer"));
}

TEST(Health, IsDegradedByWheelsThatCannotBeWheels) {
  const Time now = kStart + Duration{60 * kSecond};
  PerceptionReport report = mapping(now);
  report.wheel_fault.kind = WheelFaultKind::kNonsense;
  EXPECT_EQ(at(report, now).light, RobotLight::kDegraded);
  EXPECT_EQ(at(report, now).reason, kWheelsReadWrong);
  report.wheel_fault.kind = WheelFaultKind::kRightStands;
  EXPECT_EQ(at(report, now).reason, kWheelStands);
  report.has_pose = false;
  EXPECT_EQ(at(report, now).light, RobotLight::kStarting);
  EXPECT_EQ(at(report, now).reason, kWheelStands);
}

TEST(Health, IsDegradedWhileTheRobotIsLost) {
  const Time now = kStart + Duration{60 * kSecond};
  PerceptionReport report = mapping(now);
  report.tracking = TrackingState::kHeld;
  EXPECT_EQ(at(report, now).light, RobotLight::kMapping);
  report.tracking = TrackingState::kLost;
  EXPECT_EQ(at(report, now).light, RobotLight::kDegraded);
  EXPECT_THAT(at(report, now).reason, HasSubstr("lost"));
}

TEST(Health, IsDegradedAsLongAsTheSetUpIsDoubtfulOrWrong) {
  const Time now = kStart + Duration{60 * kSecond};
  PerceptionReport report = mapping(now);
  report.verdict.reasons.push_back(
      {SetupCode::kNotJudgedYet, VerdictState::kDoubtful, 0.0, 0.0, true});
  EXPECT_EQ(at(report, now).light, RobotLight::kMapping) << "no robot has been judged at its start";
  report.verdict.reasons.clear();
  report.verdict.reasons.push_back(
      {SetupCode::kWheelsSlipped, VerdictState::kDoubtful, 12.0, 3.0, false});
  EXPECT_EQ(at(report, now).light, RobotLight::kMapping) << "it was long ago";
  report.verdict.reasons[0].active = true;
  EXPECT_EQ(at(report, now).light, RobotLight::kDegraded);
  EXPECT_EQ(at(report, now).reason, kSetupDoubtful);
  EXPECT_THAT(status_text(report, at(report, now)), HasSubstr("(wheels_slipped)"));
  report.verdict.reasons[0] = {SetupCode::kWheelsSwapped, VerdictState::kWrong, 0.0, 3.0, true};
  report.tracking = TrackingState::kLost;
  EXPECT_EQ(at(report, now).reason, kSetupWrong) << "that is why it is lost";
  EXPECT_THAT(status_text(report, at(report, now)), HasSubstr("(wheels_swapped)"));
}

// For a while, so that somebody sees it.
TEST(Health, IsDegradedAfterTheFilterHadToRepairItsNumbers) {
  const Time now = kStart + Duration{60 * kSecond};
  PerceptionReport report = mapping(now);
  report.repaired = true;
  report.last_repair = now - Duration{kSecond};
  EXPECT_EQ(at(report, now).light, RobotLight::kDegraded);
  EXPECT_EQ(at(report, now).reason, "the filter had to repair its numbers");
  report.last_repair = now - kDegradedAfterRepair;
  EXPECT_EQ(at(report, now).light, RobotLight::kMapping);
}

TEST(Health, SaysWhatIsMissing) {
  const Time now = kStart + Duration{60 * kSecond};
  PerceptionReport report = mapping(now);
  report.last_frame = now - Duration{2 * kSecond};
  EXPECT_EQ(at(report, now).light, RobotLight::kDegraded);
  EXPECT_EQ(at(report, now).reason, "no frames from the camera");
  report.camera_frozen = true;
  EXPECT_EQ(at(report, now).reason, "the camera's picture is frozen");
  report.camera_up = false;
  EXPECT_EQ(at(report, now).reason, "no camera") << "it does not open again";
  report = mapping(now);
  report.camera_frozen = true;
  EXPECT_EQ(at(report, now).light, RobotLight::kDegraded) << "at once";
  EXPECT_EQ(at(report, now).reason, "the camera's picture is frozen");
  report = mapping(now);
  report.last_frame = now - Duration{2 * kSecond};
  report.camera_up = false;
  EXPECT_EQ(at(report, now).reason, "no camera");
  report = mapping(now);
  report.last_wheels = now - Duration{2 * kSecond};
  EXPECT_EQ(at(report, now).reason, "nothing from the wheels on the CAN bus");
  report.can_up = false;
  EXPECT_EQ(at(report, now).reason, "no CAN bus");
  report.bus_off = true;
  EXPECT_EQ(at(report, now).reason, "the CAN bus is off");
  report.last_wheels = now - kFaultAfter - Duration{1};
  EXPECT_EQ(at(report, now).light, RobotLight::kFault);
  EXPECT_THAT(status_text(report, at(report, now)), HasSubstr("fault: the CAN bus is off"));
}

TEST(Health, SaysThatTimeIsShort) {
  const Time now = kStart + Duration{60 * kSecond};
  PerceptionReport report = mapping(now);
  EXPECT_EQ(at(report, now, {50, 5}).light, RobotLight::kMapping);
  EXPECT_EQ(at(report, now, {50, 6}).reason, "deadlines are missed");
  report.sheds = true;
  EXPECT_EQ(at(report, now).light, RobotLight::kDegraded);
  EXPECT_THAT(at(report, now).reason, HasSubstr("fewer corners"));
}

}  // namespace
}  // namespace zenith
