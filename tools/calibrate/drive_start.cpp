// Where the solution begins: rough, but from anywhere.

#include <cmath>
#include <map>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "slam/image/rectify.h"
#include "tools/calibrate/drive_solver.h"
#include "tools/calibrate/median.h"

namespace zenith::tools {
namespace {

constexpr double kLeastTurn_rad = 0.06;
constexpr std::size_t kLeastPairs = 8;

struct RayPair {
  Eigen::Vector3d before;
  Eigen::Vector3d now;
};

std::vector<RayPair> common(const DriveFrame& a, const DriveFrame& b) {
  std::map<int, Eigen::Vector3d> rays;
  for (const Sighting& s : a.sightings) rays[s.track] = s.ray;
  std::vector<RayPair> pairs;
  for (const Sighting& s : b.sightings) {
    const auto found = rays.find(s.track);
    if (found != rays.end()) pairs.push_back({found->second, s.ray});
  }
  return pairs;
}

// The turn that takes `before` to `now` best (Wahba's problem), outliers weighed down.
Eigen::Matrix3d turn_between(const std::vector<RayPair>& pairs) {
  Eigen::Matrix3d Q = Eigen::Matrix3d::Identity();
  for (int round = 0; round < 5; ++round) {
    Eigen::Matrix3d B = Eigen::Matrix3d::Zero();
    for (const RayPair& p : pairs) {
      const double off = round == 0 ? 0.0 : (p.now - Q * p.before).norm() / 0.01;
      B += p.now * p.before.transpose() / (1.0 + off * off);
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(B, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant();
    Q = svd.matrixU() * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
  }
  return Q;
}

// The vertical in the camera frame, by the axis of turns on the spot; zero without any.
Eigen::Vector3d vertical(const DriveData& data) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int turns = 0;
  for (std::size_t i = 1; i < data.frames.size(); ++i) {
    const WheelTravel travel = data.travel(data.frames[i - 1].time_s, data.frames[i].time_s, 0.0);
    const Pose2 moved = wheel_motion(data.believed.wheels, travel);
    if (std::abs(moved.theta_rad) < kLeastTurn_rad) continue;
    if (moved.position().norm() > 0.3 * std::abs(moved.theta_rad)) continue;
    const auto pairs = common(data.frames[i - 1], data.frames[i]);
    if (pairs.size() < kLeastPairs) continue;
    // The scene turns the other way.
    const Eigen::AngleAxisd turn(turn_between(pairs));
    sum -= std::copysign(turn.angle(), moved.theta_rad) * turn.axis();
    ++turns;
  }
  return turns < 5 ? Eigen::Vector3d::Zero() : sum.normalized();
}

// The robot's forward in the levelled camera's axes, by the flow on straight ways; zero without.
Eigen::Vector2d forward(const DriveData& data, const Eigen::Matrix3d& levelled) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::size_t i = 1; i < data.frames.size(); ++i) {
    const WheelTravel travel = data.travel(data.frames[i - 1].time_s, data.frames[i].time_s, 0.0);
    const Pose2 moved = wheel_motion(data.believed.wheels, travel);
    if (std::abs(moved.theta_rad) > 0.3 * std::abs(moved.x_m)) continue;
    const auto pairs = common(data.frames[i - 1], data.frames[i]);
    if (pairs.size() < kLeastPairs) continue;
    std::vector<double> x;
    std::vector<double> y;
    for (const RayPair& p : pairs) {
      const Eigen::Vector3d a = levelled * p.before;
      const Eigen::Vector3d b = levelled * p.now;
      if (a.z() < 0.2 || b.z() < 0.2) continue;
      const Eigen::Vector2d flow =
          b.head<2>() / b.z() - rotation(-moved.theta_rad) * (a.head<2>() / a.z());
      x.push_back(flow.x());
      y.push_back(flow.y());
    }
    if (x.size() < kLeastPairs) continue;
    const Eigen::Vector2d flow(median(x), median(y));
    sum -= std::copysign(1.0, moved.x_m) * flow;
  }
  return sum;
}

}  // namespace

DriveUnknowns start_of_drive(const DriveData& data) {
  DriveUnknowns u;
  const RobotConfig& robot = data.believed;
  u.R_base_camera = mount_rotation(robot.mount);
  u.lever_m = {robot.mount.x_m, robot.mount.y_m};
  u.scale = 0.5 * (robot.wheels.left_scale + robot.wheels.right_scale);
  u.ratio = (robot.wheels.left_scale - robot.wheels.right_scale) / u.scale;
  u.track_width_m = robot.wheels.track_width_m;
  const Eigen::Vector3d up = vertical(data);
  Eigen::Matrix3d levelled = u.R_base_camera;
  if (up.norm() > 0.5) {
    levelled = Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    // Keep the believed yaw until the flow says better.
    const Eigen::Vector3d x = levelled * u.R_base_camera.transpose() * Eigen::Vector3d::UnitX();
    u.R_base_camera =
        Eigen::AngleAxisd(-std::atan2(x.y(), x.x()), Eigen::Vector3d::UnitZ()) * levelled;
  }
  const Eigen::Vector2d ahead = forward(data, levelled);
  if (ahead.norm() > 0.05) {
    u.R_base_camera =
        Eigen::AngleAxisd(-std::atan2(ahead.y(), ahead.x()), Eigen::Vector3d::UnitZ()) * levelled;
  }
  return u;
}

}  // namespace zenith::tools
