// From the simulator through files and SLAM to the outputs, with few seconds of driving.

#include "tools/replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/recording/candump.h"
#include "platform/recording/ground_truth.h"
#include "platform/recording/layout.h"
#include "platform/recording/robot_file.h"
#include "platform/recording/seconds.h"
#include "platform/recording/wheel_log.h"
#include "sim/view_angle.h"
#include "tests/support/wheel_bases.h"
#include "tests/unit/tools/temporary_folder.h"
#include "tools/atomic_output.h"
#include "tools/replay_judgement.h"
#include "tools/runner/simulated_source.h"
#include "tools/runner/team_run.h"
#include "tools/simulate.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ReplayTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const auto names = write_simulation({"corridor-rooms", 5, 3.0}, folder_->path() / "rec", {});
    ASSERT_TRUE(names.ok()) << names.error().message;
    names_ = new std::vector<std::string>(*names);
  }
  static void TearDownTestSuite() {
    delete names_;
    delete folder_;
  }

  static ReplayPlan plan() {
    ReplayPlan plan;
    plan.seed = 5;
    for (const std::string& name : *names_) {
      plan.recordings.push_back(folder_->path() / "rec" / name);
    }
    return plan;
  }
  static fs::path make(const char* name) {
    const fs::path path = folder_->path() / name;
    fs::create_directory(path);
    return path;
  }

  static TemporaryFolder* folder_;
  static std::vector<std::string>* names_;
};

TemporaryFolder* ReplayTest::folder_ = nullptr;
std::vector<std::string>* ReplayTest::names_ = nullptr;

TEST_F(ReplayTest, TwiceTheSameBitForBit) {
  const fs::path one = make("one");
  const fs::path two = make("two");
  const auto first = replay(plan(), one, {});
  ASSERT_TRUE(first.ok()) << first.error().message;
  EXPECT_THAT(first->warnings, testing::IsEmpty());
  ASSERT_TRUE(replay(plan(), two, {}).ok());
  for (const std::string& name : *names_) {
    for (const char* file :
         {"trajectory.tum", "landmarks.csv", "alignments.csv", "confidence.csv"}) {
      EXPECT_EQ(read_text(one / name / file), read_text(two / name / file)) << name << file;
    }
  }
  EXPECT_EQ(read_text(one / "map.png"), read_text(two / "map.png"));
}

TEST_F(ReplayTest, FilesLoseNothingThatMatters) {
  // In memory, with the very same seed: only the CAN stamps' nanoseconds are lost in the files.
  Parameters parameters;
  auto team = simulate_team("corridor-rooms", 5, 3.0, parameters);
  ASSERT_TRUE(team.ok()) << team.error().message;
  const auto log = run_team(team->sources, {parameters, 5}, {});
  ASSERT_TRUE(log.ok());
  const auto result = replay(plan(), make("files"), {});
  ASSERT_TRUE(result.ok());
  const TeamFigures memory = judge(*log);
  ASSERT_EQ(memory.robots.size(), result->figures.robots.size());
  for (std::size_t i = 0; i < memory.robots.size(); ++i) {
    EXPECT_EQ(memory.robots[i].name, result->figures.robots[i].name);
    EXPECT_EQ(memory.robots[i].frames, result->figures.robots[i].frames);
    EXPECT_NEAR(memory.robots[i].path_m, result->figures.robots[i].path_m, 0.02);
    EXPECT_NEAR(*memory.robots[i].odometry_ate_m, *result->figures.robots[i].odometry_ate_m, 1e-4);
  }
}

// A copy of a recording in which another base sends what the AgileX one measured.
void become(const WheelBase& base, const fs::path& recording) {
  const auto wheels = read_wheel_log(layout::can_log(recording, "can0"), "can0", WheelDecoder());
  ASSERT_TRUE(wheels.ok()) << wheels.error().message;
  const auto& samples = wheels->samples;
  std::string log;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const WheelSample& before = samples[i > 0 ? i - 1 : 0];
    const WheelSample& after = samples[std::min(i + 1, samples.size() - 1)];
    const double time_s = (after.stamp - before.stamp).seconds();
    for (const CanFrame& frame : base.send({samples[i].stamp, samples[i].left_m, samples[i].right_m,
                                            (after.left_m - before.left_m) / time_s,
                                            (after.right_m - before.right_m) / time_s})) {
      log += format_candump(frame, "can0") + "\n";
    }
  }
  write_text(layout::can_log(recording, "can0"), log);
  auto robot = read_robot_file(layout::robot(recording));
  ASSERT_TRUE(robot.ok()) << robot.error().message;
  robot->odometry = base.config;
  write_text(layout::robot(recording), format_robot_file(*robot));
  write_text(recording / "bases.dbc", kWheelBasesDbc);
}

TEST_F(ReplayTest, EveryBaseGivesTheSameDrive) {
  ReplayPlan one = plan();
  one.recordings.resize(1);
  const auto expected = replay(one, make("agilex"), {});
  ASSERT_TRUE(expected.ok());
  const RobotFigures& agilex = expected->figures.robots[0];
  for (const WheelBase& base : all_wheel_bases("bases.dbc")) {
    SCOPED_TRACE(base.name);
    const fs::path folder = make(base.name.c_str());
    ReplayPlan same = plan();
    same.recordings = {folder / (*names_)[0]};
    fs::copy(plan().recordings[0], same.recordings[0], fs::copy_options::recursive);
    become(base, same.recordings[0]);
    const auto result = replay(same, make((base.name + "_out").c_str()), {});
    ASSERT_TRUE(result.ok()) << result.error().message;
    EXPECT_THAT(result->warnings, testing::IsEmpty());
    const RobotFigures& robot = result->figures.robots[0];
    EXPECT_EQ(robot.frames, agilex.frames);
    EXPECT_NEAR(robot.path_m, agilex.path_m, 0.03);
    EXPECT_NEAR(*robot.odometry_ate_m, *agilex.odometry_ate_m, 0.003);
    EXPECT_NEAR(*robot.ate_m, *agilex.ate_m, 0.01);
  }
}

// The poses that a base makes of its wheels, an arc from each sample to the next.
std::string poses_of(const std::vector<WheelSample>& samples, double track_width_m) {
  std::string text;
  Pose2 pose{-4.0, 2.5, 1.0};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i > 0) {
      const double left = samples[i].left_m - samples[i - 1].left_m;
      const double right = samples[i].right_m - samples[i - 1].right_m;
      const double half = 0.5 * (right - left) / track_width_m;
      const double chord = 0.5 * (left + right) * (half == 0.0 ? 1.0 : std::sin(half) / half);
      pose = {pose.x_m + chord * std::cos(pose.theta_rad + half),
              pose.y_m + chord * std::sin(pose.theta_rad + half),
              wrap_angle(pose.theta_rad + 2.0 * half)};
    }
    text += format_tum({samples[i].stamp, pose});
  }
  return text;
}

// Those lines of poses whose stamps are 0.1 s apart.
std::string at_10_hz(const std::string& tum) {
  std::string text;
  double last_s = -1.0;
  for (std::size_t at = 0; at < tum.size();) {
    const std::size_t end = tum.find('\n', at) + 1;
    const std::string line = tum.substr(at, end - at);
    at = end;
    if (std::stod(line) < last_s + 0.099 && end < tum.size()) continue;
    last_s = std::stod(line);
    text += line;
  }
  return text;
}

// The wheels' travel and the base's own poses in place of the CAN log: the same trajectory.
TEST_F(ReplayTest, TravelAndPosesGiveTheSameTrajectoryAsTheCanLog) {
  ReplayPlan one = plan();
  one.recordings.resize(1);
  const fs::path can_out = make("can_out");
  ASSERT_TRUE(replay(one, can_out, {}).ok());
  const std::string& name = (*names_)[0];
  const auto expected = read_tum(can_out / name / "trajectory.tum");
  ASSERT_TRUE(expected.ok() && expected->size() > 20);
  const auto robot = read_robot_file(layout::robot(one.recordings[0]));
  const auto wheels =
      read_wheel_log(layout::can_log(one.recordings[0], "can0"), "can0", WheelDecoder());
  ASSERT_TRUE(robot.ok() && wheels.ok());
  std::string csv = "stamp,left_m,right_m\n";
  for (const WheelSample& sample : wheels->samples) {
    csv += format_seconds(sample.stamp) + "," + std::to_string(sample.left_m) + "," +
           std::to_string(sample.right_m) + "\n";
  }
  const std::string tum = poses_of(wheels->samples, robot->wheels.track_width_m);
  struct Form {
    const char* what;
    const char* file;
    std::string text;
  };
  for (const auto& [what, file, text] :
       {Form{"travel", "odometry.csv", csv}, Form{"poses", "odometry.tum", tum},
        Form{"poses_10_hz", "odometry.tum", at_10_hz(tum)}}) {
    SCOPED_TRACE(what);
    const fs::path folder = make((std::string(what) + "_rec").c_str()) / name;
    fs::copy(one.recordings[0], folder, fs::copy_options::recursive);
    fs::remove(layout::can_log(folder, "can0"));
    write_text(folder / file, text);
    ReplayPlan other = plan();
    other.recordings = {folder};
    const fs::path out = make((std::string(what) + "_out").c_str());
    const auto result = replay(other, out, {});
    ASSERT_TRUE(result.ok()) << result.error().message;
    EXPECT_THAT(result->warnings, testing::IsEmpty());
    const auto got = read_tum(out / name / "trajectory.tum");
    ASSERT_TRUE(got.ok());
    ASSERT_EQ(got->size(), expected->size());
    double worst_m = 0.0;
    for (std::size_t i = 0; i < got->size(); ++i) {
      worst_m =
          std::max(worst_m, ((*got)[i].pose.position() - (*expected)[i].pose.position()).norm());
    }
    RecordProperty(std::string(what) + "_worst_mm", std::to_string(1e3 * worst_m));
    // What lies between rare poses is not known: other particles win here and there.
    EXPECT_LT(worst_m, text.size() < tum.size() / 2 ? 0.005 : 0.001);
  }
}

TEST_F(ReplayTest, IsJudgedFromItsFilesAlike) {
  const fs::path out = make("judged");
  const auto result = replay(plan(), out, {});
  ASSERT_TRUE(result.ok());
  const auto judged = judge_output(out, plan().recordings);
  ASSERT_TRUE(judged.ok()) << judged.error().message;
  for (std::size_t i = 0; i < judged->robots.size(); ++i) {
    EXPECT_EQ(judged->robots[i].name, result->figures.robots[i].name);
    EXPECT_NEAR(*judged->robots[i].ate_m, *result->figures.robots[i].ate_m, 1e-5);
    EXPECT_EQ(judged->robots[i].landmarks, result->figures.robots[i].landmarks);
  }
  fs::remove(out / "summary.json");
  EXPECT_THAT(judge_output(out, plan().recordings).error().message, HasSubstr("summary.json"));
  fs::remove(out / (*names_)[0] / "alignments.csv");
  EXPECT_THAT(judge_output(out, plan().recordings).error().message, HasSubstr("alignments.csv"));
}

TEST_F(ReplayTest, ADamagedRecordingLeavesNoOutput) {
  const fs::path copy = folder_->path() / "copy";
  fs::copy(plan().recordings[0], copy, fs::copy_options::recursive);
  for (const auto& frame : fs::directory_iterator(layout::frames(copy))) {
    fs::resize_file(frame.path(), 100);
  }
  ReplayPlan damaged = plan();
  damaged.recordings = {copy};
  const fs::path target = folder_->path() / "never";
  {
    auto output = AtomicFolder::create(target, false, "summary.json");
    ASSERT_TRUE(output.ok());
    const auto result = replay(damaged, output->path(), {});
    ASSERT_FALSE(result.ok());
    EXPECT_THAT(result.error().message, HasSubstr("truncated PNG"));
  }
  EXPECT_FALSE(fs::exists(target));
  damaged.reading.skip_damaged = true;
  EXPECT_THAT(replay(damaged, make("scrap"), {}).error().message, HasSubstr("no frame is left"));
}

TEST_F(ReplayTest, TellsAllRecordingsThatAreBad) {
  ReplayPlan bad = plan();
  bad.recordings = {folder_->path() / "x", folder_->path() / "y", plan().recordings[0],
                    plan().recordings[0]};
  const std::string message = replay(bad, make("bad"), {}).error().message;
  EXPECT_THAT(message, HasSubstr("/x: no such folder"));
  EXPECT_THAT(message, HasSubstr("/y: no such folder"));
  EXPECT_THAT(message, HasSubstr("two recordings are named"));
}

TEST(Simulate, UnknownWorldsAreToldWithNearOnes) {
  EXPECT_TRUE(check_worlds({"corridor-rooms"}).ok());
  const Status checked = check_worlds({"corridor-room", "nowhere-at-all"});
  ASSERT_FALSE(checked.ok());
  EXPECT_THAT(checked.error().message, HasSubstr("near: corridor-rooms"));
  EXPECT_THAT(checked.error().message, HasSubstr("no world 'nowhere-at-all'"));
}

TEST(ViewAngle, CoversTheCornerOfTheRectifiedImage) {
  Parameters parameters;
  parameters.rectified_fov_deg = 90.0;
  RobotConfig robot;
  // The corner of a 90 degree image: atan(sqrt 2) = 54.74 degrees; four more as a margin.
  EXPECT_NEAR(sim::max_view_angle_deg(parameters.rectified_fov_deg, robot), 58.7356, 1e-3);
  robot.mount.pitch_rad = 0.1;
  EXPECT_NEAR(sim::max_view_angle_deg(parameters.rectified_fov_deg, robot), 58.7356 + 5.7296, 1e-3);
}

}  // namespace
}  // namespace zenith::tools
