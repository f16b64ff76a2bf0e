// Figures of one robot: path, errors of the trajectory, return to the start, times of the step.

#include "tools/report/robot_figures.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "tools/report/ate.h"
#include "tools/report/pose_jumps.h"

namespace zenith::tools {
namespace {

using Points = std::vector<Eigen::Vector2d>;

double percentile(const std::vector<double>& sorted, double fraction) {
  if (sorted.empty()) return 0.0;
  const double rank = fraction * static_cast<double>(sorted.size() - 1);
  return sorted[static_cast<std::size_t>(rank + 0.5)];
}

double length_of(const Points& points) {
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

// The first frame from which the robot is nearer to its start than `near_m`, having been farther
// away than `far_m`; points.size() when it never comes back.
std::size_t first_return(const Points& truth, double far_m, double near_m) {
  bool away = false;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double distance = (truth[i] - truth[0]).norm();
    away = away || distance > far_m;
    if (away && distance < near_m) return i;
  }
  return truth.size();
}

// Errors in the start frame, where estimate and truth agree at the first frame by definition.
std::optional<ReturnFigures> judge_return(const RobotLog& log, const Points& truth) {
  constexpr double kSight_m = 5.0;  // a ceiling of ordinary height is not seen from farther away
  constexpr double kFar_m = 8.0;
  constexpr double kNear_m = 1.0;
  constexpr double kAfter_m = 2.0;  // driven past the return
  const std::size_t back = first_return(truth, kFar_m, kNear_m);
  if (back == truth.size()) return std::nullopt;
  const Pose2 T_start_world = log.frames[0].truth->inverse();
  const auto error_at = [&](std::size_t i) {
    return (log.frames[i].T_start_robot.position() - T_start_world * truth[i]).norm();
  };
  std::size_t before = back;
  while ((truth[before] - truth[0]).norm() < kSight_m) --before;
  std::size_t after = back;
  double driven = 0.0;
  while (after + 1 < truth.size() && driven < kAfter_m) {
    driven += (truth[after + 1] - truth[after]).norm();
    ++after;
  }
  ReturnFigures figures;
  figures.time_s = (log.frames[back].stamp - log.frames[0].stamp).seconds();
  figures.driven_m =
      length_of(Points(truth.begin(), truth.begin() + static_cast<long>(before) + 1));
  figures.before_m = error_at(before);
  figures.after_m = error_at(after);
  return figures;
}

EndFigures judge_end(const FrameLog& first, const FrameLog& last) {
  const Pose2 truth = first.truth->inverse() * *last.truth;
  const Pose2& pose = last.T_start_robot;
  const Eigen::Vector3d e(pose.x_m - truth.x_m, pose.y_m - truth.y_m,
                          wrap_angle(pose.theta_rad - truth.theta_rad));
  const Eigen::Matrix3d& P = last.pose_covariance;
  EndFigures figures;
  figures.position_m = e.head<2>().norm();
  figures.angle_rad = std::abs(e.z());
  figures.stated_position_m = std::sqrt(P(0, 0) + P(1, 1));
  figures.stated_angle_rad = std::sqrt(P(2, 2));
  figures.nees = e.dot(P.ldlt().solve(e));
  return figures;
}

}  // namespace

StepTimes judge_steps(const RobotLog& log) {
  std::vector<double> times;
  for (const FrameLog& frame : log.frames) times.push_back(1e3 * frame.step_s);
  std::sort(times.begin(), times.end());
  return {percentile(times, 0.5), percentile(times, 0.95), percentile(times, 1.0)};
}

RobotFigures judge_robot(const RobotLog& log) {
  RobotFigures figures;
  figures.name = log.name;
  figures.frames = static_cast<int>(log.frames.size());
  figures.landmarks = static_cast<int>(log.landmarks.size());
  figures.step = judge_steps(log);
  figures.verdict = log.verdict;
  figures.setup = log.setup;
  if (log.frames.empty()) return figures;
  figures.duration_s = (log.frames.back().stamp - log.frames.front().stamp).seconds();
  Points path;
  Points estimate;
  Points odometry;
  Points truth;
  for (const FrameLog& frame : log.frames) {
    path.push_back(frame.T_start_robot.position());
    if (!frame.truth) continue;
    estimate.push_back(frame.T_start_robot.position());
    odometry.push_back(frame.odometry.position());
    truth.push_back(frame.truth->position());
  }
  figures.path_m = length_of(path);
  if (truth.size() < 2) return figures;
  figures.true_path_m = length_of(truth);
  figures.ate_m = absolute_trajectory_error(estimate, truth).rmse_m;
  figures.odometry_ate_m = absolute_trajectory_error(odometry, truth).rmse_m;
  if (truth.size() != log.frames.size()) return figures;
  figures.end = judge_end(log.frames.front(), log.frames.back());
  figures.loop = judge_return(log, truth);
  const std::vector<PoseJump> jumps = find_jumps(log.frames);
  figures.jumps = static_cast<int>(jumps.size());
  figures.wrong_jumps = static_cast<int>(
      std::count_if(jumps.begin(), jumps.end(), [](const PoseJump& jump) { return jump.wrong; }));
  return figures;
}

}  // namespace zenith::tools
