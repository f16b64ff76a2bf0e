#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "platform/recording/ground_truth.h"
#include "tests/unit/tools/synthetic_log.h"
#include "tests/unit/tools/temporary_folder.h"
#include "tools/report/confidence_picture.h"
#include "tools/report/figures_text.h"
#include "tools/report/files.h"
#include "tools/report/map_picture.h"
#include "tools/report/table.h"

namespace zenith::tools {
namespace {

using testing::HasSubstr;

TeamLog merged_team() {
  TeamLog team = synthetic_team();
  const Pose2 T = synthetic_transform(0);
  add_alignment(team.robots[0], 1, AlignmentState::kCandidate, T, 205, 250);
  add_alignment(team.robots[0], 1, AlignmentState::kMerged, T, 250, 600);
  for (RobotLog& robot : team.robots) {
    for (std::uint32_t i = 0; i < 40; ++i) {
      LandmarkEstimate mark;
      mark.id = i + 1;
      mark.position_m = {1.5 * i, i % 2 == 0 ? 1.0 : -1.0, 2.5};
      mark.covariance_m2 = 1e-3 * Eigen::Matrix3d::Identity();
      mark.observations = 12;
      robot.landmarks.push_back(mark);
      robot.fused.push_back({mark, i < 10 ? 2 : 1, -1});
    }
  }
  return team;
}

TEST(Files, HoldWhatTheRunGave) {
  const TemporaryFolder folder;
  const TeamLog team = merged_team();
  ASSERT_TRUE(write_files(folder.path(), team, judge(team), {}).ok());

  const auto trajectory = read_tum(folder.path() / "a" / "trajectory.tum");
  ASSERT_TRUE(trajectory.ok()) << trajectory.error().message;
  ASSERT_EQ(trajectory->size(), 600U);
  EXPECT_EQ((*trajectory)[7].stamp, team.robots[0].frames[7].stamp);
  EXPECT_NEAR((*trajectory)[7].pose.x_m, 0.7, 1e-6);

  const std::string marks = read_text(folder.path() / "a" / "landmarks.csv");
  EXPECT_THAT(marks, HasSubstr("id,x_m,y_m,z_m,var_xx,var_xy,var_yy,var_zz,observations\n"
                               "1,0.00000,1.00000,2.50000,0.001,0,0.001,0.001,12\n"));

  const std::string alignments = read_text(folder.path() / "a" / "alignments.csv");
  EXPECT_THAT(alignments, HasSubstr("time_s,peer,state,x_m,y_m,theta_rad,var_x,var_y,var_theta,"
                                    "confidence,correspondences\n"
                                    "21.500000000,b,candidate,20.000000,0.000000,1.57079633,"));
  EXPECT_THAT(alignments, HasSubstr("\n26.000000000,b,merged,"));
  EXPECT_THAT(alignments, HasSubstr("\n60.900000000,b,merged,")) << "the last frame";

  const std::string confidence = read_text(folder.path() / "a" / "confidence.csv");
  EXPECT_THAT(confidence, HasSubstr("frame,time_s,peer,confidence\n0,1.000000000,b,0.0000\n"));
  EXPECT_THAT(confidence, HasSubstr("\n250,26.000000000,b,0.8000\n"));

  const auto summary = nlohmann::json::parse(read_text(folder.path() / "summary.json"));
  EXPECT_EQ(summary["robots"][0]["name"], "a");
  EXPECT_EQ(summary["robots"][0]["merges"], 1);
  EXPECT_EQ(summary["robots"][0]["memory_bytes"], 1000);
  EXPECT_EQ(summary["robots"][0]["memory"][1]["part"], "looks");
  EXPECT_EQ(summary["robots"][0]["memory"][1]["bytes"], 100);
  EXPECT_EQ(summary["pairs"][0]["merge_time_s"], 25.0);
}

TEST(Files, TellAMergeThatIsGoneAsWithdrawn) {
  const TemporaryFolder folder;
  TeamLog team = synthetic_team();
  add_alignment(team.robots[0], 1, AlignmentState::kMerged, synthetic_transform(0), 250, 300);
  ASSERT_TRUE(write_files(folder.path(), team, judge(team), {}).ok());
  EXPECT_THAT(read_text(folder.path() / "a" / "alignments.csv"),
              HasSubstr("\n31.000000000,b,withdrawn,"));
}

// How many pixels are near this colour.
int count_colour(const cv::Mat& picture, int red, int green, int blue) {
  int count = 0;
  for (int v = 0; v < picture.rows; ++v) {
    for (int u = 0; u < picture.cols; ++u) {
      const cv::Vec3b bgr = picture.at<cv::Vec3b>(v, u);
      const int off = std::abs(bgr[0] - blue) + std::abs(bgr[1] - green) + std::abs(bgr[2] - red);
      count += off < 40 ? 1 : 0;
    }
  }
  return count;
}

TEST(Pictures, ShowEveryRobotAndTheCommonLandmarks) {
  const TemporaryFolder folder;
  const TeamLog team = merged_team();
  ASSERT_TRUE(draw_map(folder.path() / "map.png", team, judge(team)).ok());
  const cv::Mat map = cv::imread((folder.path() / "map.png").string());
  ASSERT_EQ(map.cols, 1600);
  EXPECT_GT(count_colour(map, 0, 98, 178), 200) << "a";
  EXPECT_GT(count_colour(map, 222, 93, 0), 200) << "b";
  EXPECT_GT(count_colour(map, 214, 20, 160), 30) << "common landmarks";
  EXPECT_GT(count_colour(map, 255, 255, 255), map.rows * map.cols / 2) << "paper";

  ASSERT_TRUE(draw_confidence(folder.path() / "confidence.png", team, 0.5).ok());
  const cv::Mat confidence = cv::imread((folder.path() / "confidence.png").string());
  ASSERT_EQ(confidence.cols, 1600);
  EXPECT_GT(count_colour(confidence, 214, 20, 160), 500) << "threshold";
}

TEST(Pictures, DoWithoutMergesLandmarksAndFrames) {
  const TemporaryFolder folder;
  TeamLog team = synthetic_team();
  EXPECT_TRUE(draw_map(folder.path() / "map.png", team, judge(team)).ok());
  team.robots[1].frames.clear();
  EXPECT_TRUE(draw_map(folder.path() / "map.png", team, judge(team)).ok());
  team.robots[0].frames.clear();
  EXPECT_TRUE(draw_map(folder.path() / "map.png", team, judge(team)).ok());
  EXPECT_TRUE(draw_confidence(folder.path() / "confidence.png", team, 0.5).ok());
  EXPECT_FALSE(draw_confidence(folder.path() / "none" / "confidence.png", team, 0.5).ok());
}

TEST(Table, AlignsColumns) {
  Table table({"name", "n"});
  table.add({"a°", "10"});
  table.add({"bcdef", "7"});
  EXPECT_EQ(table.text(1), " name    n\n ---------\n a°     10\n bcdef   7\n");
  EXPECT_EQ(fixed(std::nullopt, 2), "-");
  EXPECT_EQ(fixed(1.005, 1), "1.0");
  EXPECT_EQ(median_and_worst({3.0, 1.0, 2.0, 10.0}, 1), "2.5 / 10.0");
  EXPECT_EQ(median_and_worst({}, 1), "-");
}

}  // namespace
}  // namespace zenith::tools
