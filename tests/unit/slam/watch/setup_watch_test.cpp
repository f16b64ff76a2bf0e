// Each wrong set-up has its own verdict, a right one has none, and what happens on the way is told.

#include "slam/watch/setup_watch.h"

#include <memory>

#include <gtest/gtest.h>

#include "tests/support/seeds.h"
#include "tests/support/watch_rig.h"

namespace zenith {
namespace {

using point_world::SetupFaults;
using point_world::WatchRig;

constexpr double kDegree = std::numbers::pi / 180.0;

std::unique_ptr<WatchRig> drive_with(const SetupFaults& faults, int legs = 6) {
  const TestSeed seed;
  auto rig = std::make_unique<WatchRig>(faults, seed.value());
  rig->drive_about(legs);
  return rig;
}

// The gravest reason, and no other one of a wrong set-up.
void expect_wrong(const SetupFaults& faults, SetupCode code) {
  SCOPED_TRACE(setup_code_name(code));
  const auto rig = drive_with(faults);
  EXPECT_EQ(rig->verdict().state, VerdictState::kWrong) << rig->reasons();
  ASSERT_FALSE(rig->verdict().reasons.empty());
  EXPECT_EQ(rig->verdict().reasons[0].code, code) << rig->reasons();
  int wrong = 0;
  for (const Reason& r : rig->verdict().reasons) wrong += r.severity == VerdictState::kWrong;
  EXPECT_EQ(wrong, 1) << rig->reasons();
}

void expect_doubtful(const SetupFaults& faults, SetupCode code) {
  SCOPED_TRACE(setup_code_name(code));
  const auto rig = drive_with(faults);
  EXPECT_NE(rig->verdict().state, VerdictState::kGood) << rig->reasons();
  EXPECT_TRUE(rig->says(code)) << rig->reasons();
}

TEST(SetupWatch, ARightSetUpIsGood) {
  for (const double yaw : {0.0, 0.5 * std::numbers::pi, std::numbers::pi}) {
    SetupFaults right;
    right.mount_yaw_rad = yaw;
    const auto rig = drive_with(right, 12);
    EXPECT_EQ(rig->verdict().state, VerdictState::kGood) << rig->reasons();
    const SetupMeasures& m = rig->measures();
    EXPECT_TRUE(m.judged);
    EXPECT_NEAR(m.turn_scale, 1.0, 0.01);
    EXPECT_NEAR(m.wheel_balance, 0.0, 0.01);
    EXPECT_NEAR(m.yaw_error_rad, 0.0, 1.0 * kDegree);
    EXPECT_NEAR(m.height_m, 2.25, 0.1);
    EXPECT_NEAR(m.delay_s, 0.0, 0.015);
    EXPECT_LT(m.vertical.norm(), 0.02);
    EXPECT_NEAR(m.lens.focal, 0.0, 0.01);
    EXPECT_NEAR(m.lens.ahead, 0.0, 0.005);
    EXPECT_LT(m.lens.focal_sigma, 0.02);
  }
}

TEST(SetupWatch, IsNotGoodBeforeItHasSeenEnough) {
  const TestSeed seed;
  WatchRig rig({}, seed.value());
  rig.drive(3.0, 0.0, 0.0);
  EXPECT_EQ(rig.verdict().state, VerdictState::kDoubtful);
  EXPECT_TRUE(rig.says(SetupCode::kNotJudgedYet)) << rig.reasons();
}

TEST(SetupWatch, TellsAMirroredPicture) {
  SetupFaults faults;
  faults.mirrored = true;
  expect_wrong(faults, SetupCode::kPictureMirrored);
  faults.mount_yaw_rad = 0.5 * std::numbers::pi;  // forward stays forward
  expect_wrong(faults, SetupCode::kPictureMirrored);
}

TEST(SetupWatch, TellsAWrongYawAndHowWrong) {
  for (const double degrees : {180.0, 90.0, -90.0, 45.0, 12.0, -12.0}) {
    SetupFaults faults;
    faults.yaw_error_rad = degrees * kDegree;
    expect_wrong(faults, SetupCode::kYawWrong);
    const auto rig = drive_with(faults);
    EXPECT_NEAR(std::abs(rig->measures().yaw_error_rad), std::abs(faults.yaw_error_rad),
                1.0 * kDegree);
  }
  SetupFaults some;
  some.yaw_error_rad = 4.0 * kDegree;
  expect_doubtful(some, SetupCode::kYawWrong);
}

TEST(SetupWatch, TellsExchangedAndReversedWheels) {
  SetupFaults swapped;
  swapped.swapped = true;
  expect_wrong(swapped, SetupCode::kWheelsSwapped);
  SetupFaults left;
  left.left_factor = -1.0;
  expect_wrong(left, SetupCode::kLeftReversed);
  SetupFaults right;
  right.right_factor = -1.0;
  expect_wrong(right, SetupCode::kRightReversed);
  SetupFaults both;
  both.left_factor = both.right_factor = -1.0;
  expect_wrong(both, SetupCode::kWheelsReversed);
}

TEST(SetupWatch, ARobotThatDrivesBackwardIsGood) {
  SetupFaults faults;
  faults.backward = true;
  const auto rig = drive_with(faults);
  EXPECT_EQ(rig->verdict().state, VerdictState::kGood) << rig->reasons();
}

TEST(SetupWatch, TellsAWrongScaleOfTheWheels) {
  for (const double factor : {0.8, 1.08, 1.3}) {
    SetupFaults faults;
    faults.left_factor = faults.right_factor = factor;
    expect_wrong(faults, SetupCode::kTurnScale);
    const auto rig = drive_with(faults);
    EXPECT_NEAR(1.0 / rig->measures().turn_scale, factor, 0.02);
  }
  SetupFaults one;
  one.left_factor = 1.08;
  expect_doubtful(one, SetupCode::kWheelsUnequal);
}

TEST(SetupWatch, TellsAWrongFocalLength) {
  for (const double error : {-0.2, -0.1, 0.1, 0.25}) {
    SetupFaults faults;
    faults.focal_error = error;
    expect_doubtful(faults, SetupCode::kFocalWrong);
    const auto rig = drive_with(faults);
    EXPECT_GT(rig->measures().lens.focal * error,
              0.0);  // of the first order: no more than the side
  }
}

TEST(SetupWatch, TellsAnAxisThatIsOffAheadFromDrivingStraight) {
  for (const double ahead : {-0.04, 0.04}) {
    SetupFaults faults;
    faults.axis_ahead = ahead;
    const TestSeed seed;
    WatchRig rig(faults, seed.value());
    for (int i = 0; i < 8; ++i) rig.drive(8.0, i % 2 == 0 ? 0.4 : -0.4, 0.0);
    EXPECT_NEAR(rig.measures().lens.ahead, ahead, 0.01);
    EXPECT_TRUE(rig.says(SetupCode::kLensWrong)) << rig.reasons();
  }
}

TEST(SetupWatch, TellsHowFarStampsAreApart) {
  for (const double late_s : {-0.2, -0.06, 0.06, 0.12, 0.3}) {
    SetupFaults faults;
    faults.wheels_late_s = late_s;
    expect_doubtful(faults, SetupCode::kStampsApart);
    const auto rig = drive_with(faults);
    EXPECT_NEAR(rig->measures().delay_s, late_s, 0.015);
  }
  SetupFaults jitter;
  jitter.jitter_s = 0.025;
  expect_doubtful(jitter, SetupCode::kStampsJitter);
}

TEST(SetupWatch, TellsALensWhoseVerticalLiesElsewhere) {
  SetupFaults faults;
  faults.tilt_rad = 8.0 * kDegree;
  expect_wrong(faults, SetupCode::kLensWrong);
  faults.tilt_rad = 3.0 * kDegree;
  expect_doubtful(faults, SetupCode::kLensWrong);
}

TEST(SetupWatch, TellsWhatOfTheRobotIsInView) {
  SetupFaults faults;
  faults.standing = 25;
  expect_doubtful(faults, SetupCode::kRobotInView);
}

TEST(SetupWatch, TellsAFrozenPictureAndRepeatedOnes) {
  const auto frozen = drive_with({}, 2);
  frozen->picture_held = true;
  frozen->drive(4.0, 0.3, 0.1);
  EXPECT_TRUE(frozen->says(SetupCode::kPictureFrozen)) << frozen->reasons();
  EXPECT_EQ(frozen->verdict().state, VerdictState::kWrong);

  const auto twice = drive_with({}, 2);
  for (int i = 0; i < 60; ++i) {
    twice->picture_held = i % 2 == 1;
    twice->drive(0.1, 0.3, i % 20 < 10 ? 0.2 : -0.2);
  }
  EXPECT_TRUE(twice->says(SetupCode::kFramesRepeated)) << twice->reasons();

  // Standing, the same picture is no fault.
  const auto standing = drive_with({}, 4);
  standing->picture_held = true;
  standing->drive(10.0, 0.0, 0.0);
  EXPECT_EQ(standing->verdict().state, VerdictState::kGood) << standing->reasons();
}

TEST(SetupWatch, TellsACoveredLens) {
  const auto rig = drive_with({}, 4);
  rig->dark = true;
  rig->drive(4.0, 0.3, 0.0);
  EXPECT_TRUE(rig->says(SetupCode::kLensCovered)) << rig->reasons();
}

TEST(SetupWatch, TellsSlipsPushesAndLifts) {
  const auto slipped = drive_with({}, 4);
  slipped->drive(0.5, 0.4, 0.0, true, false);
  slipped->drive_about(1);
  EXPECT_TRUE(slipped->says(SetupCode::kWheelsSlipped)) << slipped->reasons();

  const auto turned = drive_with({}, 4);
  turned->drive(1.0, 0.0, 0.4, false, true);
  turned->drive_about(1);
  EXPECT_TRUE(turned->says(SetupCode::kRobotPushed)) << turned->reasons();

  const auto lifted = drive_with({}, 4);
  lifted->put_down({-4.0, 4.5, 2.0});
  lifted->drive_about(2);
  EXPECT_TRUE(lifted->says(SetupCode::kViewJumped)) << lifted->reasons();
}

TEST(SetupWatch, ASmallSlipIsTheFiltersBusiness) {
  const auto rig = drive_with({}, 4);
  rig->drive(0.1, 0.3, 0.0, true, false);
  rig->drive_about(2);
  EXPECT_EQ(rig->verdict().state, VerdictState::kGood) << rig->reasons();
}

}  // namespace
}  // namespace zenith
