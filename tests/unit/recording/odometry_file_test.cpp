// The wheels of a recording out of a CAN log, odometry.csv and odometry.tum: one interface, the
// same samples, the same checks.

#include "platform/recording/odometry_file.h"

#include <cmath>
#include <cstdio>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "platform/recording/layout.h"
#include "platform/recording/pose_travel.h"
#include "platform/recording/recording.h"
#include "platform/recording/seconds.h"
#include "platform/recording/travel_file.h"
#include "tests/support/seeds.h"
#include "tests/unit/tools/small_recording.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kTrack_m = 0.437;

std::string csv_line(const WheelSample& sample) {
  char text[96];
  std::snprintf(text, sizeof text, ",%.9f,%.9f\n", sample.left_m, sample.right_m);
  return format_seconds(sample.stamp) + text;
}

// What a base with this track width makes of the wheels' travel: an arc from each sample to the
// next.
std::vector<StampedPose> drive(const std::vector<WheelSample>& samples, double track_width_m) {
  std::vector<StampedPose> poses = {{samples.front().stamp, {3.0, -2.0, 3.0}}};
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double left = samples[i].left_m - samples[i - 1].left_m;
    const double right = samples[i].right_m - samples[i - 1].right_m;
    const double turn = (right - left) / track_width_m;
    const double way = 0.5 * (left + right);
    const double heading = poses.back().pose.theta_rad;
    Pose2 to = poses.back().pose;
    if (std::abs(turn) < 1e-12) {
      to.x_m += way * std::cos(heading);
      to.y_m += way * std::sin(heading);
    } else {  // about the centre of the arc
      const double radius = way / turn;
      to.x_m += radius * (std::sin(heading + turn) - std::sin(heading));
      to.y_m -= radius * (std::cos(heading + turn) - std::cos(heading));
    }
    to.theta_rad = wrap_angle(heading + turn);
    poses.push_back({samples[i].stamp, to});
  }
  return poses;
}

std::string tum_text(const std::vector<StampedPose>& poses) {
  std::string text;
  char line[200];
  for (const StampedPose& pose : poses) {
    std::snprintf(line, sizeof line, " %.12f %.12f 0 0 0 %.15f %.15f\n", pose.pose.x_m,
                  pose.pose.y_m, std::sin(0.5 * pose.pose.theta_rad),
                  std::cos(0.5 * pose.pose.theta_rad));
    text += format_seconds(pose.stamp) + line;
  }
  return text;
}

Result<WheelLog> read_csv(const std::string& text, const WheelCodecConfig& config = {}) {
  InputLines lines(text, "odometry.csv", {1 << 20});
  return parse_travel_file(lines, config);
}

Result<WheelLog> read_poses(const std::string& text, RobotFile robot = {}) {
  if (robot.wheels.track_width_m == Wheels().track_width_m) robot.wheels.track_width_m = kTrack_m;
  InputLines lines(text, "odometry.tum", {1 << 24});
  return parse_pose_travel(lines, robot);
}

void expect_same(const std::vector<WheelSample>& got, const std::vector<WheelSample>& expected,
                 double within_m) {
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i) {
    ASSERT_EQ(got[i].stamp, expected[i].stamp) << i;
    ASSERT_NEAR(got[i].left_m, expected[i].left_m - expected[0].left_m, within_m) << i;
    ASSERT_NEAR(got[i].right_m, expected[i].right_m - expected[0].right_m, within_m) << i;
  }
}

// Forward, backward, on the spot, about either wheel, along curves, standing.
std::vector<WheelSample> mixed_drive() {
  const double pairs[][2] = {{0.5, 0.5},  {-0.4, -0.4}, {0.3, -0.3}, {-0.6, 0.6},  {0.0, 0.4},
                             {-0.4, 0.0}, {0.5, 0.45},  {0.0, 0.0},  {-0.3, -0.5}, {0.2, -0.1}};
  std::vector<WheelSample> samples = {{Time{1'000'000'000}, 7.0, -3.0}};
  for (const auto& [left_mps, right_mps] : pairs) {
    for (int i = 0; i < 40; ++i) {
      const WheelSample& last = samples.back();
      samples.push_back({last.stamp + Duration{50'000'000}, last.left_m + 0.05 * left_mps,
                         last.right_m + 0.05 * right_mps});
    }
  }
  return samples;
}

TEST(PoseTravel, AnArcGivesTheTravelThatDroveIt) {
  const TestSeed seed;
  Random random(seed.value());
  for (int i = 0; i < 2000; ++i) {
    const double turn = random.uniform(-1.9, 1.9);
    const double way = random.uniform(-1.0, 1.0) * (i % 3 == 0 ? 0.0 : 1.0);
    const double left = way - 0.5 * kTrack_m * turn;
    const double right = way + 0.5 * kTrack_m * turn;
    const auto poses = drive({{Time{0}, 0.0, 0.0}, {Time{1}, left, right}}, kTrack_m);
    const ArcTravel arc = arc_travel(poses[0].pose, poses[1].pose, kTrack_m);
    ASSERT_NEAR(arc.left_m, left, 1e-12) << turn << " " << way;
    ASSERT_NEAR(arc.right_m, right, 1e-12) << turn << " " << way;
    ASSERT_NEAR(arc.sideways_m, 0.0, 1e-12);
  }
}

TEST(PoseTravel, AMixedDriveComesBack) {
  const auto samples = mixed_drive();
  const auto log = read_poses(tum_text(drive(samples, kTrack_m)));
  ASSERT_TRUE(log.ok()) << log.error().message;
  expect_same(log->samples, samples, 1e-8);
  EXPECT_THAT(describe_log(*log, "odometry.tum"), IsEmpty());
}

// Millimetres, and quaternions of five decimals: what many programs print. It must not add up.
TEST(PoseTravel, RoundedPosesDoNotDrift) {
  const auto samples = mixed_drive();
  std::string text;
  char line[160];
  for (const StampedPose& pose : drive(samples, kTrack_m)) {
    std::snprintf(line, sizeof line, " %.3f %.3f 0.0 0.0 0.0 %.5f %.5f\n", pose.pose.x_m,
                  pose.pose.y_m, std::sin(0.5 * pose.pose.theta_rad),
                  std::cos(0.5 * pose.pose.theta_rad));
    text += format_seconds(pose.stamp) + line;
  }
  const auto log = read_poses(text);
  ASSERT_TRUE(log.ok()) << log.error().message;
  EXPECT_NEAR(log->samples.back().left_m, samples.back().left_m - samples[0].left_m, 0.005);
  EXPECT_NEAR(log->samples.back().right_m, samples.back().right_m - samples[0].right_m, 0.005);
}

// NumPy's way to write numbers.
// Wheels that speed up, slow down, turn back and stand, with poses at 10 Hz and at 5 Hz.
TEST(PoseTravel, BetweenRarePosesTheWheelsSpeedUpEvenly) {
  const auto travel = [](double t, double phase) {  // speeds of 0 to 0.6 m/s, then backward
    const double at = std::min(t, 9.0);
    return 0.3 * at - 0.3 / 1.2 * std::sin(1.2 * at + phase) - (t > 9.0 ? 0.2 * (t - 9.0) : 0.0);
  };
  for (const auto& [rate_hz, within_m] : {std::pair{10, 3e-4}, std::pair{5, 1.5e-3}}) {
    std::vector<WheelSample> samples;
    std::vector<StampedPose> poses;
    for (int i = 0; i <= 12'000; ++i) {
      const double t = 1e-3 * i;
      samples.push_back({Time{1'000'000'000 + i * 1'000'000LL}, travel(t, 0.0), travel(t, 1.0)});
    }
    const auto all = drive(samples, kTrack_m);
    for (std::size_t i = 0; i < all.size(); i += static_cast<std::size_t>(1000 / rate_hz)) {
      poses.push_back(all[i]);
    }
    const auto log = read_poses(tum_text(poses));
    ASSERT_TRUE(log.ok()) << log.error().message;
    EXPECT_GT(log->samples.size(), 12U * 39U);
    double worst_m = 0.0;
    for (const WheelSample& sample : log->samples) {
      const double t = (sample.stamp - samples[0].stamp).seconds();
      if (std::abs(t - 9.0) < 2.0 / rate_hz) continue;  // there the speed jumps
      worst_m = std::max({worst_m, std::abs(sample.left_m - travel(t, 0.0) + travel(0.0, 0.0)),
                          std::abs(sample.right_m - travel(t, 1.0) + travel(0.0, 1.0))});
    }
    EXPECT_LT(worst_m, within_m) << rate_hz;
  }
}

TEST(PoseTravel, BetweenRarePosesStandingIsStandingAndNothingOvershoots) {
  std::string text;
  const double x_m[] = {0, 0, 0, 0.03, 0.05, 0.05, 0.05, 0.02, 0.02};
  for (std::size_t i = 0; i < std::size(x_m); ++i) {
    text += std::to_string(10.0 + 0.1 * static_cast<double>(i)) + " " + std::to_string(x_m[i]) +
            " 0 0 0 0 0 1\n";
  }
  const auto log = read_poses(text);
  ASSERT_TRUE(log.ok()) << log.error().message;
  ASSERT_EQ(log->samples.size(), 8U * 4U + 1U);
  for (std::size_t i = 0; i < 32; ++i) {
    const auto [low, high] = std::minmax(x_m[i / 4], x_m[i / 4 + 1]);
    EXPECT_GE(log->samples[i].left_m, low - 1e-12) << i;
    EXPECT_LE(log->samples[i].left_m, high + 1e-12) << i;
    EXPECT_EQ(log->samples[i].left_m, log->samples[i].right_m) << i;
  }
}

TEST(PoseTravel, ReadsExponents) {
  const auto log = read_poses(
      "1.436509052249713000e+09 0.0e+00 0 0 0 0 0 1.0e+00\n"
      "1.436509052349713000e+09 1.0e-02 0 0 0 0 0 1.0e+00\n");
  ASSERT_TRUE(log.ok()) << log.error().message;
  EXPECT_EQ(log->samples.back().stamp.ns, 1436509052349713000);
  EXPECT_NEAR(log->samples.back().left_m, 0.01, 1e-12);
}

// The base's own track width makes its poses; what calibration says of it corrects them.
TEST(PoseTravel, TheTrackWidthOfThePosesIsTheBasesOwn) {
  const auto samples = mixed_drive();
  RobotFile robot;
  robot.wheels.track_width_m = 0.5;
  robot.poses_track_width_m = kTrack_m;
  const auto log = read_poses(tum_text(drive(samples, kTrack_m)), robot);
  ASSERT_TRUE(log.ok()) << log.error().message;
  expect_same(log->samples, samples, 1e-8);
}

TEST(PoseTravel, OdometryThatIsPutBackIsARestart) {
  const auto samples = mixed_drive();
  auto poses = drive(samples, kTrack_m);
  const Pose2 base = poses[200].pose;
  for (std::size_t i = 200; i < poses.size(); ++i) {
    const double dx = poses[i].pose.x_m - base.x_m;
    const double dy = poses[i].pose.y_m - base.y_m;
    const double c = std::cos(base.theta_rad);
    const double s = std::sin(base.theta_rad);
    poses[i].pose = {c * dx + s * dy, -s * dx + c * dy,
                     wrap_angle(poses[i].pose.theta_rad - base.theta_rad)};
  }
  const auto log = read_poses(tum_text(poses));
  ASSERT_TRUE(log.ok()) << log.error().message;
  EXPECT_EQ(log->decoder.resets, 1U);
  // One step is lost, no more.
  EXPECT_NEAR(log->samples.back().left_m, samples.back().left_m - samples[0].left_m, 0.05);
  EXPECT_THAT(describe_log(*log, "odometry.tum"),
              ElementsAre(HasSubstr("1 restarts of the base's counters")));
}

TEST(PoseTravel, PosesThatAreNoBasesAreRefused) {
  // 15 cm in front of the wheels, the robot turns on the spot.
  std::string text;
  for (int i = 0; i < 100; ++i) {
    const double theta = 0.05 * i;
    text += tum_text(
        {{Time{i * 50'000'000LL}, {0.15 * std::cos(theta), 0.15 * std::sin(theta), theta}}});
  }
  EXPECT_THAT(read_poses(text).error().message,
              AllOf(HasSubstr("odometry.tum: the poses move sideways by 0.7"),
                    HasSubstr("middle between the two wheels")));
  EXPECT_THAT(read_poses("1.0 0 0 0 0 0 0 1\n1.1 0 0 0 0.7071068 0 0 0.7071068\n").error().message,
              AllOf(HasSubstr("odometry.tum:2: the pose leans by 90 degrees"),
                    HasSubstr("pose of a camera")));
  EXPECT_THAT(
      read_poses("1.0 0 0 0 0 0 0 1\n2.0 0 0 0 0 0 0.9 0.4358899\n").error().message,
      AllOf(HasSubstr("odometry.tum:2: turns by 128 degrees in 1.00 s"), HasSubstr("more often")));
  RobotFile robot;
  robot.odometry.swap_wheels = true;
  EXPECT_THAT(read_poses("1.0 0 0 0 0 0 0 1\n", robot).error().message,
              HasSubstr("do not apply to poses"));
}

TEST(TravelFile, ReadsWhatPeopleWrite) {
  const char* const texts[] = {
      "1.0,0.1,0.2\n1.1,0.2,0.4\n",
      "stamp,left_m,right_m\n1.0,0.1,0.2\n1.1,0.2,0.4\n",
      "# of the 2nd floor\n\n#stamp,left_m,right_m\n1.0,0.1,0.2\n# between\n1.1,0.2,0.4\n",
      "stamp;left_m;right_m\r\n1.0;0.1;0.2\r\n1.1;0.2;0.4\r\n",
      "stamp left_m right_m\n  1.0   0.1  0.2\n1.1 0.2 0.4",
      "right_m,battery,left_m,stamp\n0.2,99,0.1,1.0\n0.4,98,0.2,1.1\n",
      "\"timestamp [ns]\",\"left [m]\",\"right [m]\"\n1000000000,0.1,0.2\n1100000000,0.2,0.4\n",
      "#timestamp [ns],left_m,right_m\n1000000000,0.1,0.2\n1100000000,0.2,0.4\n",
      "time_s\tleft_travel_m\tright_travel_m\n1.0\t0.1\t+2e-1\n1.1\t0.2\t0.4\n",
      "t,left,right\n1.000000000e+00,0.1,0.2\n1.1,0.2,0.4\n",
  };
  for (const char* text : texts) {
    SCOPED_TRACE(text);
    const auto log = read_csv(text);
    ASSERT_TRUE(log.ok()) << log.error().message;
    EXPECT_THAT(describe_log(*log, "odometry.csv"), IsEmpty());
    expect_same(log->samples, {{Time{1'000'000'000}, 0.1, 0.2}, {Time{1'100'000'000}, 0.2, 0.4}},
                1e-12);
  }
}

TEST(TravelFile, RefusesWhatIsNotTravel) {
  const auto refusal = [](const char* text) {
    const auto log = read_csv(text);
    return log.ok() ? "" : log.error().message;
  };
  EXPECT_THAT(refusal("stamp,left_mps,right_mps\n1,0,0\n"),
              AllOf(HasSubstr("odometry.csv:1: expected 'stamp,left_m,right_m'"),
                    HasSubstr("'left_mps' is in another unit")));
  EXPECT_THAT(refusal("stamp,left_ticks,right_ticks\n1,0,0\n"), HasSubstr("another unit"));
  EXPECT_THAT(refusal("stamp,left [mm],right [mm]\n1,0,0\n"), HasSubstr("another unit"));
  EXPECT_THAT(refusal("stamp_ms,left_m,right_m\n1,0,0\n"), HasSubstr("neither seconds nor"));
  EXPECT_THAT(refusal("stamp,x,y,theta\n1,0,0,0\n"), HasSubstr("heading 'stamp,x,y,theta'"));
  EXPECT_THAT(refusal("stamp,left_m,left_rear_m,right_m\n"), HasSubstr("heading"));
  EXPECT_THAT(refusal("1436509052249713000,0.1,0.2\n"),
              AllOf(HasSubstr("holds no odometry"), HasSubstr("odometry.csv:1: expected")));
  EXPECT_THAT(refusal(""), HasSubstr("holds no odometry"));
  EXPECT_THAT(refusal("# nothing\nstamp,left_m,right_m\n"), HasSubstr("holds no odometry"));
}

TEST(TravelFile, WheelsMayBeExchangedAndReversed) {
  WheelCodecConfig config;
  config.swap_wheels = true;
  config.invert_left = true;
  config.latency_s = 0.25;
  const auto log = read_csv("1.5,0.0,0.0\n1.6,0.1,0.3\n", config);
  ASSERT_TRUE(log.ok()) << log.error().message;
  expect_same(log->samples, {{Time{1'250'000'000}, 0.0, 0.0}, {Time{1'350'000'000}, -0.3, 0.1}},
              1e-12);
}

// A recording in which the wheels come from any of the three files.
struct Form {
  const char* name;
  const char* file;
  std::string (*write)(const std::vector<WheelSample>&);
};

std::string as_can(const std::vector<WheelSample>& samples) {
  std::string log;
  for (const WheelSample& sample : samples) {
    char text[96];
    std::snprintf(text, sizeof text, "(%010lld.%06lld) can0 311#%08X%08X\n",
                  static_cast<long long>(sample.stamp.ns / 1'000'000'000),
                  static_cast<long long>(sample.stamp.ns % 1'000'000'000 / 1000),
                  static_cast<unsigned>(std::lround(1000.0 * sample.left_m)),
                  static_cast<unsigned>(std::lround(1000.0 * sample.right_m)));
    log += text;
  }
  return log;
}

std::string as_csv(const std::vector<WheelSample>& samples) {
  std::string text;
  for (const WheelSample& sample : samples) text += csv_line(sample);
  return text;
}

std::string as_tum(const std::vector<WheelSample>& samples) {
  return tum_text(drive(samples, kTrack_m));
}

class OdometryForm : public testing::TestWithParam<Form> {
 protected:
  void SetUp() override {
    write_small_recording(folder_);
    fs::remove(layout::can_log(folder_, "can0"));
  }
  fs::path file() const { return folder_ / GetParam().file; }
  // Every 20 ms from the first frame to after the last, in whole millimetres.
  static std::vector<WheelSample> samples() {
    std::vector<WheelSample> samples;
    for (int i = 0; i <= 60; ++i) {
      samples.push_back({Time{1'000'000'000 + i * 20'000'000LL}, 0.010 * i, 0.011 * i});
    }
    return samples;
  }
  // The message of the first error, or "".
  std::string read_all(const ReadOptions& options = {}) {
    auto recording = Recording::open(folder_, options);
    if (!recording.ok()) return recording.error().message;
    SourceFrame frame;
    wheels_.clear();
    for (;;) {
      const auto more = (*recording)->next(frame);
      if (!more.ok()) return more.error().message;
      if (!*more) break;
      wheels_.insert(wheels_.end(), frame.wheels.begin(), frame.wheels.end());
    }
    warnings_ = (*recording)->warnings();
    return "";
  }

  TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path() / "ada";
  std::vector<WheelSample> wheels_;
  std::vector<std::string> warnings_;
};

TEST_P(OdometryForm, DeliversTheSameWheels) {
  write_text(file(), GetParam().write(samples()));
  EXPECT_EQ(read_all(), "");
  EXPECT_THAT(warnings_, IsEmpty());
  ASSERT_GT(wheels_.size(), 40U);
  auto expected = samples();
  expected.resize(wheels_.size());
  expect_same(wheels_, expected, 1e-8);
}

TEST_P(OdometryForm, TellsGaps) {
  auto some = samples();
  some.erase(some.begin() + 3, some.begin() + 40);
  write_text(file(), GetParam().write(some));
  EXPECT_EQ(read_all(), "");
  EXPECT_THAT(warnings_, ElementsAre(AllOf(HasSubstr(GetParam().file), HasSubstr("1 gap "),
                                           HasSubstr("0.76 s after 1.04"))));
}

TEST_P(OdometryForm, CountsStampsThatDoNotRise) {
  const std::string good = GetParam().write(samples());
  const std::size_t line = good.find('\n', good.size() / 2) + 1;
  const std::string one = good.substr(line, good.find('\n', line) + 1 - line);
  const std::string first = good.substr(0, good.find('\n') + 1);
  write_text(file(), good.substr(0, line) + one + one + first + good.substr(line + one.size()));
  EXPECT_EQ(read_all(), "");
  EXPECT_THAT(warnings_,
              ElementsAre(HasSubstr("2 odometry readings whose stamps do not rise, refused")));
  auto expected = samples();
  expected.resize(wheels_.size());
  expect_same(wheels_, expected, 1e-8);
}

TEST_P(OdometryForm, NumbersThatAreNoneAreToldWithTheirLine) {
  for (const char* bad : {"nan", "inf", "1e999", "x", ""}) {
    std::string text = GetParam().write(samples());
    const std::size_t end = text.find('\n', text.find('\n') + 1);
    const std::size_t begin = text.find_last_of(", #", end) + 1;
    text.replace(begin, end - begin, *bad == 0 && begin > 0 ? "!" : bad);
    write_text(file(), text);
    EXPECT_EQ(read_all(), "") << bad;
    EXPECT_THAT(warnings_, ElementsAre(HasSubstr(std::string(GetParam().file) + ":2: "))) << bad;
  }
}

TEST_P(OdometryForm, RefusesAnotherClock) {
  auto late = samples();
  for (WheelSample& sample : late)
    sample.stamp = sample.stamp + Duration{1'436'509'051'000'000'000};
  write_text(file(), GetParam().write(late));
  EXPECT_THAT(read_all(), AllOf(HasSubstr(GetParam().file), HasSubstr("no time in common")));
}

TEST_P(OdometryForm, NamesStampsInAnotherUnit) {
  for (const auto& [factor, unit] : {std::pair{1'000LL, "milliseconds"}, {1'000'000LL, "micro"}}) {
    auto scaled = samples();
    for (WheelSample& sample : scaled) sample.stamp.ns *= factor;
    write_text(file(), GetParam().write(scaled));
    EXPECT_THAT(read_all(), HasSubstr(unit));
  }
}

TEST_P(OdometryForm, NamesLinesInTheWrongOrder) {
  auto reversed = samples();
  std::reverse(reversed.begin(), reversed.end());
  reversed.front().stamp.ns += 1'000'000'000;
  write_text(file(), GetParam().write(reversed));
  EXPECT_THAT(read_all(), HasSubstr("stamps do not rise"));
}

TEST_P(OdometryForm, WheelsThatNeverMoveAreNamed) {
  auto standing = samples();
  for (const double end_s : {5.0, 20.0}) {
    for (WheelSample& sample : standing) sample.left_m = sample.right_m = 1.0;
    standing.back().stamp = standing.front().stamp + Duration::from_seconds(end_s);
    write_text(file(), GetParam().write(standing));
    EXPECT_EQ(read_all(), "");
    EXPECT_EQ(testing::Value(warnings_, testing::Contains(HasSubstr("never move"))), end_s > 10.0)
        << end_s;
  }
}

TEST_P(OdometryForm, AnImpossibleStepIsARestart) {
  auto jump = samples();
  for (std::size_t i = 30; i < jump.size(); ++i) {
    jump[i].left_m += 40.0;
    jump[i].right_m += 40.0;
  }
  write_text(file(), GetParam().write(jump));
  EXPECT_EQ(read_all(), "");
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("1 restarts of the base's counters")));
  EXPECT_LT(wheels_.back().left_m, 0.6);
}

TEST_P(OdometryForm, ExactlyOneFileIsTaken) {
  write_text(file(), GetParam().write(samples()));
  for (const Form& other : {Form{"", "can0.log", as_can}, Form{"", "odometry.csv", as_csv},
                            Form{"", "odometry.tum", as_tum}}) {
    if (folder_ / other.file == file()) continue;
    write_text(folder_ / other.file, other.write(samples()));
    EXPECT_THAT(read_all(), AllOf(HasSubstr("hold the wheels of this recording, expected one"),
                                  HasSubstr(GetParam().file), HasSubstr(other.file),
                                  HasSubstr("remove odometry.")));
    fs::remove(folder_ / other.file);
  }
  EXPECT_EQ(read_all(), "");
}

TEST_P(OdometryForm, OnlyACanLogNeedsACodec) {
  write_text(file(), GetParam().write(samples()));
  write_text(layout::robot(folder_),
             "[wheels]\ntrack_width_m = 0.437\nleft_scale = 1.0\nright_scale = 1.0\n");
  const std::string message = read_all();
  if (file().extension() == ".log") {
    EXPECT_THAT(message, HasSubstr("missing key odometry.codec"));
  } else {
    EXPECT_EQ(message, "");
  }
}

INSTANTIATE_TEST_SUITE_P(Of, OdometryForm,
                         testing::Values(Form{"Can", "can0.log", as_can},
                                         Form{"Csv", "odometry.csv", as_csv},
                                         Form{"Tum", "odometry.tum", as_tum}),
                         [](const auto& form) { return form.param.name; });

TEST(FindOdometry, TellsOfLogsWithOtherNames) {
  TemporaryFolder temporary;
  write_text(temporary.path() / "candump-2026-12-01_093000.log", "");
  EXPECT_THAT(find_odometry(temporary.path(), "can0").error().message,
              AllOf(HasSubstr("can0.log: missing"), HasSubstr("odometry.csv or odometry.tum"),
                    HasSubstr("found candump-2026-12-01_093000.log: rename the log")));
}

}  // namespace
}  // namespace zenith::tools
