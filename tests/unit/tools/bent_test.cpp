// A drive through rendered pixels, made wrong in the most telling ways: each is told, with its
// code, and the right one is good. The whole battery is `zenith eval --bent`.

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/bent/battery.h"
#include "tools/bent/bends.h"
#include "tools/report/figures_text.h"

namespace zenith::tools {
namespace {

using testing::HasSubstr;

TEST(BentBattery, ItsQuickPartIsToldWithTheRightCodes) {
  BatteryPlan plan;
  plan.worlds = {"corridor-rooms"};
  plan.duration_s = 36.0;
  plan.quick = true;
  const std::vector<BatteryRun> runs = run_battery(plan, {});
  const std::map<std::string, SetupCode> codes = {
      {"mirror", SetupCode::kPictureMirrored},  {"yaw 90 deg", SetupCode::kYawWrong},
      {"swap", SetupCode::kWheelsSwapped},      {"invert left", SetupCode::kLeftReversed},
      {"late 100 ms", SetupCode::kStampsApart}, {"slip 11 cm left", SetupCode::kWheelsSlipped},
      {"frozen", SetupCode::kPictureFrozen},
  };
  std::size_t told = 0;
  for (const BatteryRun& run : runs) {
    SCOPED_TRACE(run.bend);
    ASSERT_EQ(run.failure, "");
    ASSERT_TRUE(run.figures.verdict);
    EXPECT_FALSE(run.silent());
    EXPECT_FALSE(run.false_alarm());
    if (run.unbent) continue;
    const auto code = codes.find(run.bend);
    ASSERT_NE(code, codes.end());
    EXPECT_TRUE(gives(*run.figures.verdict, code->second)) << battery_text({run});
    ++told;
  }
  EXPECT_EQ(told, codes.size());
}

TEST(BentBattery, CallsWhatIsOffAndGoodSilent) {
  BatteryRun run;
  run.world = "w";
  run.bend = "b";
  run.figures.ate_m = 0.09;
  run.figures.verdict.emplace();
  run.figures.verdict->state = VerdictState::kGood;
  EXPECT_TRUE(run.silent());
  EXPECT_THAT(battery_text({run}), HasSubstr("SILENT"));
  run.figures.verdict->state = VerdictState::kDoubtful;
  EXPECT_FALSE(run.silent());
  EXPECT_FALSE(run.false_alarm());
  run.unbent = true;
  EXPECT_TRUE(run.false_alarm());
  EXPECT_THAT(battery_text({run}), HasSubstr("1 false alarms"));
}

TEST(Verdicts, AreToldAsTextAndAsJson) {
  TeamFigures figures;
  figures.robots.resize(2);
  figures.robots[0].name = "anna";
  figures.robots[0].verdict.emplace();
  figures.robots[0].verdict->state = VerdictState::kGood;
  figures.robots[1].name = "bert";
  EXPECT_EQ(verdicts_text(figures), "  set-up of anna: good\n") << "bert was not judged by anybody";
  EXPECT_FALSE(is_wrong(figures));
  figures.robots[1].verdict.emplace();
  figures.robots[1].verdict->state = VerdictState::kWrong;
  figures.robots[1].verdict->reasons.push_back(
      {SetupCode::kYawWrong, VerdictState::kWrong, 90.0, 6.25, true});
  EXPECT_TRUE(is_wrong(figures));
  EXPECT_THAT(verdicts_text(figures),
              HasSubstr("bert: wrong\n    yaw_wrong, since 6.2 s: driving"));
  const nlohmann::json json = figures_json(figures);
  EXPECT_EQ(json["robots"][0]["verdict"]["state"], "good");
  EXPECT_TRUE(json["robots"][0]["verdict"]["reasons"].empty());
  const nlohmann::json& reason = json["robots"][1]["verdict"]["reasons"][0];
  EXPECT_EQ(reason["code"], "yaw_wrong");
  EXPECT_DOUBLE_EQ(reason["since_s"], 6.25);
  EXPECT_THAT(reason["text"].get<std::string>(), HasSubstr("90.0 degrees"));
}

// --- the bends themselves -----------------------------------------------------------------------

Tape small_tape() {
  Tape tape;
  tape.name = "r1";
  tape.config.lens.width_px = 4;
  tape.config.lens.height_px = 2;
  for (int i = 0; i <= 20; ++i) {
    const Time stamp = Time{1'000'000'000} + Duration{i * std::int64_t{100'000'000}};
    Pixels pixels = {0, 1, 2, 3, 4, 5, 6, static_cast<std::uint8_t>(i)};
    tape.frames.push_back(
        {stamp, std::make_shared<const Pixels>(pixels), Pose2{0.1 * i, 0.0, 0.0}});
    tape.wheels.push_back({stamp, 0.1 * i, 0.1 * i});
  }
  return tape;
}

TEST(Bends, LeaveTheOtherCopiesOfATapeAlone) {
  const Tape tape = small_tape();
  Tape bent = tape;
  mirror_pictures(bent);
  EXPECT_EQ((*bent.frames[3].pixels)[0], 3);
  EXPECT_EQ((*tape.frames[3].pixels)[0], 0);
}

TEST(Bends, KeepWheelsContinuousOverWhatHappens) {
  for (const Bend& bend : list_bends(2.0, false)) {
    SCOPED_TRACE(bend.name);
    Tape tape = small_tape();
    bend.apply(tape);
    ASSERT_FALSE(tape.frames.empty());
    for (std::size_t i = 1; i < tape.frames.size(); ++i) {
      EXPECT_GT(tape.frames[i].stamp, tape.frames[i - 1].stamp);
    }
    for (std::size_t i = 1; i < tape.wheels.size(); ++i) {
      EXPECT_GT(tape.wheels[i].stamp, tape.wheels[i - 1].stamp);
      EXPECT_LT(std::abs(tape.wheels[i].left_m - tape.wheels[i - 1].left_m), 0.25);
    }
  }
}

TEST(Bends, ACarriedRobotGoesOnWhereItWasPutDown) {
  Tape tape = small_tape();
  carry(tape, 0.5, 1.5);
  EXPECT_NEAR(tape.duration_s(), 1.05, 1e-6);
  EXPECT_NEAR(tape.frames.back().truth->x_m, 2.0, 1e-9);
  EXPECT_NEAR(tape.wheels.back().left_m, 1.0, 1e-9) << "the wheels do not know of it";
}

TEST(Bends, APushedRobotsWheelsStand) {
  Tape tape = small_tape();
  push(tape, 0.5, 1.0);
  EXPECT_NEAR(tape.wheels.back().left_m, 1.5, 1e-9);
  EXPECT_EQ(tape.frames.back().truth->x_m, 2.0);
}

}  // namespace
}  // namespace zenith::tools
