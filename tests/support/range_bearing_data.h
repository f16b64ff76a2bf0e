#pragma once
// The UTIAS multi-robot data set (MRCLAM): five robots with odometry and range-bearing
// measurements to coded landmarks, and motion capture as the truth.
//
// Source: Leung, Halpern, Barfoot, Liu, "The UTIAS multi-robot cooperative localization and mapping
// dataset", IJRR 2011. Text files with # comments, as published.

#include <array>
#include <filesystem>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "platform/base/result.h"
#include "slam/geometry.h"

namespace zenith {

// From `time_s` on the robot was commanded to these speeds, until the next sample.
struct SpeedSample {
  double time_s = 0.0;
  double forward_mps = 0.0;
  double turn_radps = 0.0;
};

// Bearing 0 is ahead, positive to the left.
struct RangeBearing {
  double time_s = 0.0;
  int subject = 0;  // 1..5 robots, 6..20 landmarks; barcodes are already translated
  double range_m = 0.0;
  double bearing_rad = 0.0;
};

struct TruthSample {
  double time_s = 0.0;
  Pose2 pose;
};

struct RangeBearingRobot {
  std::vector<SpeedSample> odometry;
  std::vector<RangeBearing> measurements;
  std::vector<TruthSample> truth;
  int unknown_barcodes = 0;  // measurements of codes that nobody carries: misread, dropped
};

inline constexpr int kMrclamRobots = 5;

struct RangeBearingData {
  std::array<RangeBearingRobot, kMrclamRobots> robots;
  std::map<int, Eigen::Vector2d> landmarks_m;  // by subject
};

Result<RangeBearingData> load_range_bearing(const std::filesystem::path& folder);

// The true pose at a time, interpolated; false outside the truth or in a gap above 0.5 s.
bool truth_at(const std::vector<TruthSample>& truth, double time_s, Pose2& pose);

}  // namespace zenith
