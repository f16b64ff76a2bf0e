#include "platform/daemon/perception_report.h"

namespace zenith {
namespace {

// The upper triangle, row by row.
std::array<double, 6> triangle(const Eigen::Matrix3d& c) {
  return {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
}

}  // namespace

void note_step(PerceptionReport& report, const StepOutput& output) {
  report.has_pose = true;
  report.stamp = output.stamp;
  report.T_start_robot = output.T_start_robot;
  report.covariance = triangle(output.pose_covariance);
  report.T_odom_robot = output.odometry.T_odom_robot;
  report.odometry_covariance = triangle(output.odometry.covariance);
  const Eigen::Vector3d& v = output.odometry.velocity;
  report.velocity = {v.x(), v.y(), v.z()};
  report.velocity_covariance = triangle(output.odometry.velocity_covariance);
  report.effective_sample_size = output.effective_sample_size;
  report.tracking = output.tracking;
  report.corners = output.corners;
  report.candidates = output.candidates;
  report.matched = output.matched;
  report.inliers = output.inliers;
}

}  // namespace zenith
