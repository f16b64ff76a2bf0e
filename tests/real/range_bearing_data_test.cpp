// The loader of the UTIAS data: on made files, and on the real ones against what they are known
// to hold.

#include "tests/support/range_bearing_data.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/real_data.h"
#include "tests/support/rigid_fit.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;

class MadeFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() /
        ("zenith_range_bearing_" + std::to_string(testing::UnitTest::GetInstance()->random_seed()) +
         testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
    write("Barcodes.dat", "# Subject #    Barcode #\n  1 \t   5\n  6\t63 \n");
    write("Landmark_Groundtruth.dat", "# comment\n 6 0.5 -4.25 0.0001 0.0002\n");
    for (int i = 1; i <= kMrclamRobots; ++i) {
      const std::string robot = "Robot" + std::to_string(i);
      write(robot + "_Odometry.dat", "# t v w\n10.5  0.086 \t -0.398\n11.0 0.1 0.2\n");
      write(robot + "_Measurement.dat", "10.6 63 3.5 -0.25\n10.7 34 1 1\n10.8 5 2 0.5\n");
      write(robot + "_Groundtruth.dat", "10.0 1 2 3.1\n10.2 2 2 -3.1\n\n12.0 0 0 0\n");
    }
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
  }

  fs::path folder_;
};

TEST_F(MadeFiles, AreReadAsTheyAre) {
  const auto data = load_range_bearing(folder_);
  ASSERT_TRUE(data.ok()) << data.error().message;
  ASSERT_EQ(data->landmarks_m.size(), 1u);
  EXPECT_EQ(data->landmarks_m.at(6), Eigen::Vector2d(0.5, -4.25));
  const RangeBearingRobot& robot = data->robots[4];
  ASSERT_EQ(robot.odometry.size(), 2u);
  EXPECT_EQ(robot.odometry[0].forward_mps, 0.086);
  EXPECT_EQ(robot.odometry[0].turn_radps, -0.398);
  ASSERT_EQ(robot.measurements.size(), 2u);
  EXPECT_EQ(robot.unknown_barcodes, 1);
  EXPECT_EQ(robot.measurements[0].subject, 6);
  EXPECT_EQ(robot.measurements[0].range_m, 3.5);
  EXPECT_EQ(robot.measurements[0].bearing_rad, -0.25);
  EXPECT_EQ(robot.measurements[1].subject, 1);
  EXPECT_EQ(robot.truth.size(), 3u);
}

TEST_F(MadeFiles, TruthIsInterpolatedAcrossTheTurnOfAngles) {
  const auto data = load_range_bearing(folder_);
  ASSERT_TRUE(data.ok()) << data.error().message;
  Pose2 pose;
  ASSERT_TRUE(truth_at(data->robots[0].truth, 10.1, pose));
  EXPECT_NEAR(pose.x_m, 1.5, 1e-9);
  EXPECT_NEAR(std::abs(pose.theta_rad), std::numbers::pi, 1e-9);
  EXPECT_FALSE(truth_at(data->robots[0].truth, 9.9, pose)) << "before the truth";
  EXPECT_FALSE(truth_at(data->robots[0].truth, 11.0, pose)) << "in a gap";
  EXPECT_FALSE(truth_at(data->robots[0].truth, 12.1, pose)) << "after the truth";
}

TEST_F(MadeFiles, ErrorsNameFileAndLine) {
  write("Robot3_Odometry.dat", "# t v w\n1 2 3\n1 two 3\n");
  const auto bad_number = load_range_bearing(folder_);
  ASSERT_FALSE(bad_number.ok());
  EXPECT_NE(bad_number.error().message.find("Robot3_Odometry.dat:3"), std::string::npos)
      << bad_number.error().message;

  write("Robot3_Odometry.dat", "2 0 0\n1 0 0\n");
  const auto falling = load_range_bearing(folder_);
  ASSERT_FALSE(falling.ok());
  EXPECT_NE(falling.error().message.find("times fall"), std::string::npos);

  fs::remove(folder_ / "Robot2_Measurement.dat");
  const auto missing = load_range_bearing(folder_);
  ASSERT_FALSE(missing.ok());
  EXPECT_NE(missing.error().message.find("Robot2_Measurement.dat"), std::string::npos);
}

TEST(RealRangeBearingData, HoldsWhatItsAuthorsDescribe) {
  ZENITH_NEED_REAL_DATA("range_bearing_robots");
  const auto data = load_range_bearing(real_data_folder() / "range_bearing_robots");
  ASSERT_TRUE(data.ok()) << data.error().message;
  EXPECT_EQ(data->landmarks_m.size(), 15u);
  for (const RangeBearingRobot& robot : data->robots) {
    EXPECT_GT(robot.odometry.size(), 50'000u);
    EXPECT_GT(robot.measurements.size(), 1'900u);
    EXPECT_LT(robot.unknown_barcodes, 10);
    // About 15 minutes of driving, and the truth with it for most of it.
    EXPECT_NEAR(robot.odometry.back().time_s - robot.odometry.front().time_s, 886.0, 10.0);
    EXPECT_GT(robot.truth.back().time_s - robot.truth.front().time_s, 700.0);
  }
}

// Measurements agree with the truth: signs, units, clocks and barcodes are understood.
TEST(RealRangeBearingData, MeasurementsAgreeWithTheTruth) {
  ZENITH_NEED_REAL_DATA("range_bearing_robots");
  const auto data = load_range_bearing(real_data_folder() / "range_bearing_robots");
  ASSERT_TRUE(data.ok()) << data.error().message;
  for (const RangeBearingRobot& robot : data->robots) {
    int agree = 0;
    int all = 0;
    for (const RangeBearing& z : robot.measurements) {
      const auto landmark = data->landmarks_m.find(z.subject);
      Pose2 pose;
      if (landmark == data->landmarks_m.end() || !truth_at(robot.truth, z.time_s, pose)) continue;
      const Eigen::Vector2d d = pose.inverse() * landmark->second;
      const double turn = wrap_angle(std::atan2(d.y(), d.x()) - z.bearing_rad);
      agree += std::abs(d.norm() - z.range_m) < 0.5 && std::abs(turn) < 0.15 ? 1 : 0;
      ++all;
    }
    EXPECT_GT(all, 1000);
    EXPECT_GT(agree, all * 9 / 10) << agree << " of " << all;
  }
}

TEST(RigidFit, FindsTheMotionThatMadeThePoints) {
  const Pose2 T = {1.5, -2.0, 2.5};
  const std::vector<Eigen::Vector2d> a = {{0.0, 0.0}, {3.0, 1.0}, {-1.0, 4.0}};
  std::vector<Eigen::Vector2d> b;
  b.reserve(a.size());
  for (const auto& p : a) b.push_back(T * p);
  const RigidFit fit = fit_points(a, b);
  EXPECT_NEAR(fit.T_b_a.x_m, T.x_m, 1e-12);
  EXPECT_NEAR(fit.T_b_a.y_m, T.y_m, 1e-12);
  EXPECT_NEAR(fit.T_b_a.theta_rad, T.theta_rad, 1e-12);
  EXPECT_NEAR(fit.rms_m, 0.0, 1e-12);
}

}  // namespace
}  // namespace zenith
