#include "tools/calibrate/drive_solver.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "tools/calibrate/median.h"
#include "tools/calibrate/projection.h"

namespace zenith::tools {
namespace {

constexpr int kMountSize = 5;  // turn and lever arm, the part that sightings know
constexpr double kCauchy = 2.5;
constexpr std::size_t kLeastSightings = 4;
// Points are somewhere between 0.3 m above the camera and infinity.
constexpr double kRho = 0.4;
constexpr double kRhoSigma = 0.4;
// What is believed before: so little that it only keeps what a drive does not show in place.
const DriveVector kPriorSigma =
    (DriveVector() << 0.5, 0.5, 2.0, 0.3, 0.3, 0.1, 0.3, 0.1).finished();
// Of a wheel, as a drive by a good base shows it: slip after a metre, quantisation.
constexpr double kSlip = 0.003;
constexpr double kFloor_m = 0.0005;
constexpr double kLateral = 0.002;

using Matrix23 = Eigen::Matrix<double, 2, 3>;
using MountJacobian = Eigen::Matrix<double, 2, kMountSize>;

struct PointSighting {
  std::size_t frame;
  Matrix23 across;  // two axes across the ray seen
};

struct Point {
  Eigen::Vector2d c0;     // whence first seen, start frame; stays
  Eigen::Vector3d state;  // ax, ay, rho
  std::vector<PointSighting> sightings;
};

struct State {
  DriveUnknowns unknowns;
  std::vector<Pose2> poses;
  std::vector<Point> points;
};

struct Sizes {  // of the errors
  double sight_rad = 0.003;
  double odometry = 1.0;
};

double loss(double squared) {
  return kCauchy * kCauchy * std::log1p(squared / (kCauchy * kCauchy));
}
double weight_of(double squared) {
  return 1.0 / (1.0 + squared / (kCauchy * kCauchy));
}

Matrix23 axes_across(const Eigen::Vector3d& ray) {
  const Eigen::Vector3d a = ray.unitOrthogonal();
  Matrix23 B;
  B << a.transpose(), ray.cross(a).transpose();
  return B;
}

struct SightError {
  Eigen::Vector2d r;
  MountJacobian by_mount;
  Matrix23 by_pose;
  Matrix23 by_point;
};

SightError sight_error(const State& s, const Point& point, const PointSighting& sighting) {
  const Pose2& pose = s.poses[sighting.frame];
  const Eigen::Matrix2d Rt = rotation(pose.theta_rad).transpose();
  const double rho = point.state.z();
  const Eigen::Vector2d from(point.c0 - pose.position());
  const Eigen::Vector2d level = Rt * (point.state.head<2>() + rho * from);
  const Eigen::Vector2d m = level - rho * s.unknowns.lever_m;
  const Eigen::Vector3d h(m.x(), m.y(), 1.0);
  const double length = h.norm();
  const Eigen::Vector3d n = h / length;
  const Eigen::Matrix3d to_camera = s.unknowns.R_base_camera.transpose();
  const Eigen::Vector3d c = to_camera * n;
  const Matrix23 by_h =
      sighting.across * to_camera * (Eigen::Matrix3d::Identity() - n * n.transpose()) / length;
  const Eigen::Matrix2d by_m = by_h.leftCols<2>();
  SightError e;
  e.r = sighting.across * c;
  e.by_mount << sighting.across * cross_matrix(c), -rho * by_m;
  e.by_pose << -rho * by_m * Rt, by_m * Eigen::Vector2d(level.y(), -level.x());
  e.by_point << by_m * Rt, by_m * (Rt * from - s.unknowns.lever_m);
  return e;
}

struct OdometryError {
  Eigen::Vector3d r;  // whitened
  Eigen::Matrix3d by_before;
  Eigen::Matrix3d by_after;
  Eigen::Matrix3d by_wheels;  // ratio, track width, latency
};

Eigen::Vector3d driven(const DriveData& data, const DriveUnknowns& u, std::size_t i) {
  const Pose2 p = wheel_motion(
      u.wheels(), data.travel(data.frames[i].time_s, data.frames[i + 1].time_s, u.latency_s));
  return {p.x_m, p.y_m, p.theta_rad};
}

Eigen::Vector3d odometry_sigma(const DriveData& data, const DriveUnknowns& u, std::size_t i) {
  const WheelTravel t = data.travel(data.frames[i].time_s, data.frames[i + 1].time_s, u.latency_s);
  const double wheel = std::sqrt(kSlip * kSlip * 0.5 * (std::abs(t.left_m) + std::abs(t.right_m)) +
                                 2.0 * kFloor_m * kFloor_m);
  const double way = std::abs(0.5 * (t.left_m + t.right_m));
  const double turn = std::sqrt(2.0) * wheel / u.track_width_m;
  return {
      wheel / std::sqrt(2.0),
      std::sqrt(kFloor_m * kFloor_m + kLateral * kLateral * way + 0.25 * turn * turn * way * way),
      turn};
}

OdometryError odometry_error(const DriveData& data, const State& s, std::size_t i) {
  const Pose2& a = s.poses[i];
  const Pose2& b = s.poses[i + 1];
  const Eigen::Matrix2d Rt = rotation(a.theta_rad).transpose();
  const Eigen::Vector2d between = Rt * (b.position() - a.position());
  const Eigen::Vector3d u = driven(data, s.unknowns, i);
  const Eigen::Vector3d inverse = odometry_sigma(data, s.unknowns, i).cwiseInverse();
  OdometryError e;
  e.r << between - u.head<2>(), wrap_angle(b.theta_rad - a.theta_rad - u.z());
  e.by_before << -Rt, Eigen::Vector2d(between.y(), -between.x()), 0.0, 0.0, -1.0;
  e.by_after << Rt, Eigen::Vector2d::Zero(), 0.0, 0.0, 1.0;
  constexpr double kSteps[3] = {1e-5, 1e-5, 1e-3};
  for (int k = 0; k < 3; ++k) {
    DriveVector step = DriveVector::Zero();
    step(kMountSize + k) = kSteps[k];
    e.by_wheels.col(k) =
        (driven(data, s.unknowns.moved(-step), i) - driven(data, s.unknowns.moved(step), i)) /
        (2.0 * kSteps[k]);
  }
  e.r = inverse.cwiseProduct(e.r);
  e.by_before = inverse.asDiagonal() * e.by_before;
  e.by_after = inverse.asDiagonal() * e.by_after;
  e.by_wheels = inverse.asDiagonal() * e.by_wheels;
  return e;
}

double point_prior(const Point& p) {
  return std::pow((p.state.z() - kRho) / kRhoSigma, 2.0);
}

double cost_of(const DriveData& data, const State& s, const Sizes& sizes,
               const DriveVector& off_prior) {
  double cost = off_prior.cwiseQuotient(kPriorSigma).squaredNorm();
  for (const Point& point : s.points) {
    cost += point_prior(point);
    for (const PointSighting& sighting : point.sightings) {
      cost += loss(sight_error(s, point, sighting).r.squaredNorm() /
                   (sizes.sight_rad * sizes.sight_rad));
    }
  }
  for (std::size_t i = 0; i + 1 < s.poses.size(); ++i) {
    cost += loss(odometry_error(data, s, i).r.squaredNorm() / (sizes.odometry * sizes.odometry));
  }
  return cost;
}

// What is needed to find a point's step from the others'.
struct Eliminated {
  Eigen::Matrix3d V;  // of the point, undamped
  Eigen::Vector3d g;
  Eigen::Matrix<double, kMountSize, 3> by_mount;
  std::vector<Eigen::Matrix3d> by_pose;  // by sighting
};

struct Normal {
  Eigen::MatrixXd H;  // of unknowns and poses but the first
  Eigen::VectorXd g;
  std::vector<Eliminated> points;
};

Eigen::Index at_pose(std::size_t frame) {
  return kDriveSize + 3 * (static_cast<Eigen::Index>(frame) - 1);
}

void add_point(const State& s, const Point& point, double sigma, Normal& n) {
  Eliminated out;
  out.V.setZero();
  out.V(2, 2) = 1.0 / (kRhoSigma * kRhoSigma);
  out.g = {0.0, 0.0, (kRho - point.state.z()) / (kRhoSigma * kRhoSigma)};
  out.by_mount.setZero();
  for (const PointSighting& sighting : point.sightings) {
    const SightError e = sight_error(s, point, sighting);
    const double w = weight_of(e.r.squaredNorm() / (sigma * sigma)) / (sigma * sigma);
    out.V += w * e.by_point.transpose() * e.by_point;
    out.g -= w * e.by_point.transpose() * e.r;
    out.by_mount += w * e.by_mount.transpose() * e.by_point;
    out.by_pose.push_back(w * e.by_pose.transpose() * e.by_point);
    n.H.topLeftCorner<kMountSize, kMountSize>() += w * e.by_mount.transpose() * e.by_mount;
    n.g.head<kMountSize>() -= w * e.by_mount.transpose() * e.r;
    if (sighting.frame == 0) continue;
    const Eigen::Index at = at_pose(sighting.frame);
    n.H.block<3, kMountSize>(at, 0) += w * e.by_pose.transpose() * e.by_mount;
    n.H.block<3, 3>(at, at) += w * e.by_pose.transpose() * e.by_pose;
    n.g.segment<3>(at) -= w * e.by_pose.transpose() * e.r;
  }
  n.points.push_back(std::move(out));
}

void add_odometry(const DriveData& data, const State& s, std::size_t i, double size, Normal& n) {
  const OdometryError e = odometry_error(data, s, i);
  const double w = weight_of(e.r.squaredNorm() / (size * size)) / (size * size);
  const Eigen::Index after = at_pose(i + 1);
  n.H.block<3, 3>(kMountSize, kMountSize) += w * e.by_wheels.transpose() * e.by_wheels;
  n.g.segment<3>(kMountSize) -= w * e.by_wheels.transpose() * e.r;
  n.H.block<3, 3>(after, kMountSize) += w * e.by_after.transpose() * e.by_wheels;
  n.H.block<3, 3>(after, after) += w * e.by_after.transpose() * e.by_after;
  n.g.segment<3>(after) -= w * e.by_after.transpose() * e.r;
  if (i == 0) return;
  const Eigen::Index before = at_pose(i);
  n.H.block<3, 3>(before, kMountSize) += w * e.by_before.transpose() * e.by_wheels;
  n.H.block<3, 3>(before, before) += w * e.by_before.transpose() * e.by_before;
  n.H.block<3, 3>(after, before) += w * e.by_after.transpose() * e.by_before;
  n.g.segment<3>(before) -= w * e.by_before.transpose() * e.r;
}

// The lower triangle is filled.
Normal normal_equations(const DriveData& data, const State& s, const Sizes& sizes,
                        const DriveVector& off_prior) {
  const Eigen::Index size = at_pose(s.poses.size());
  Normal n{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), {}};
  const DriveVector weight = kPriorSigma.cwiseAbs2().cwiseInverse();
  n.H.diagonal().head<kDriveSize>() += weight;
  n.g.head<kDriveSize>() -= weight.cwiseProduct(off_prior);
  for (const Point& point : s.points) add_point(s, point, sizes.sight_rad, n);
  for (std::size_t i = 0; i + 1 < s.poses.size(); ++i) {
    add_odometry(data, s, i, sizes.odometry, n);
  }
  return n;
}

// The points out of the equations: H - W V^-1 W^T, with V damped by 1 + lambda.
void eliminate(const State& s, double lambda, Normal& n, std::vector<Eigen::Matrix3d>& inverse) {
  inverse.clear();
  for (std::size_t p = 0; p < s.points.size(); ++p) {
    const Eliminated& e = n.points[p];
    Eigen::Matrix3d V = e.V;
    V.diagonal() *= 1.0 + lambda;
    inverse.push_back(V.inverse());
    const Eigen::Matrix<double, kMountSize, 3> mount = e.by_mount * inverse.back();
    n.H.topLeftCorner<kMountSize, kMountSize>() -= mount * e.by_mount.transpose();
    n.g.head<kMountSize>() -= mount * e.g;
    const auto& sightings = s.points[p].sightings;
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      if (sightings[i].frame == 0) continue;
      const Eigen::Index at = at_pose(sightings[i].frame);
      const Eigen::Matrix3d pose = e.by_pose[i] * inverse.back();
      n.H.block<3, kMountSize>(at, 0) -= pose * e.by_mount.transpose();
      n.g.segment<3>(at) -= pose * e.g;
      for (std::size_t k = 0; k <= i; ++k) {  // frames rise
        if (sightings[k].frame == 0) continue;
        n.H.block<3, 3>(at, at_pose(sightings[k].frame)) -= pose * e.by_pose[k].transpose();
      }
    }
  }
}

State moved(const State& s, const Normal& n, const std::vector<Eigen::Matrix3d>& inverse,
            const Eigen::VectorXd& step) {
  State out = s;
  out.unknowns = s.unknowns.moved(step.head<kDriveSize>());
  for (std::size_t k = 1; k < s.poses.size(); ++k) {
    const Eigen::Vector3d d = step.segment<3>(at_pose(k));
    out.poses[k].x_m += d.x();
    out.poses[k].y_m += d.y();
    out.poses[k].theta_rad += d.z();
  }
  for (std::size_t p = 0; p < s.points.size(); ++p) {
    Eigen::Vector3d right = n.points[p].g;
    right -= n.points[p].by_mount.transpose() * step.head<kMountSize>();
    for (std::size_t i = 0; i < s.points[p].sightings.size(); ++i) {
      const std::size_t frame = s.points[p].sightings[i].frame;
      if (frame == 0) continue;
      right -= n.points[p].by_pose[i].transpose() * step.segment<3>(at_pose(frame));
    }
    out.points[p].state += inverse[p] * right;
    out.points[p].state.z() = std::clamp(out.points[p].state.z(), 0.01, 3.0);
  }
  return out;
}

Sizes sizes_of(const DriveData& data, const State& s) {
  std::vector<double> sights;
  std::vector<double> odometry;
  for (const Point& point : s.points) {
    for (const PointSighting& sighting : point.sightings) {
      const Eigen::Vector2d r = sight_error(s, point, sighting).r;
      sights.push_back(std::abs(r.x()));
      sights.push_back(std::abs(r.y()));
    }
  }
  for (std::size_t i = 0; i + 1 < s.poses.size(); ++i) {
    const Eigen::Vector3d r = odometry_error(data, s, i).r;
    odometry.push_back(std::abs(r.x()));
    odometry.push_back(std::abs(r.z()));
  }
  return {std::clamp(robust_sigma(sights), 2e-4, 0.1),
          std::clamp(robust_sigma(odometry), 0.5, 20.0)};
}

State starting_state(const DriveData& data, const DriveUnknowns& start) {
  State s;
  s.unknowns = start;
  s.poses.emplace_back();
  for (std::size_t i = 0; i + 1 < data.frames.size(); ++i) {
    const Eigen::Vector3d u = driven(data, start, i);
    Pose2 next = s.poses.back() * Pose2{u.x(), u.y(), u.z()};
    next.theta_rad = s.poses.back().theta_rad + u.z();
    s.poses.push_back(next);
  }
  std::map<int, Point> points;
  for (std::size_t i = 0; i < data.frames.size(); ++i) {
    for (const Sighting& sighting : data.frames[i].sightings) {
      const Eigen::Vector3d level = start.R_base_camera * sighting.ray;
      if (level.z() < 0.2) continue;
      auto [found, fresh] = points.try_emplace(sighting.track);
      Point& point = found->second;
      if (fresh) {
        const Eigen::Matrix2d R = rotation(s.poses[i].theta_rad);
        point.c0 = s.poses[i] * start.lever_m;
        point.state << R * level.head<2>() / level.z(), kRho;
      }
      point.sightings.push_back({i, axes_across(sighting.ray)});
    }
  }
  for (auto& [track, point] : points) {
    if (point.sightings.size() >= kLeastSightings) s.points.push_back(std::move(point));
  }
  return s;
}

DriveVector difference(const DriveUnknowns& from, const DriveUnknowns& to) {
  DriveVector d;
  const Eigen::AngleAxisd turn(from.R_base_camera.transpose() * to.R_base_camera);
  d << turn.angle() * turn.axis(), to.lever_m - from.lever_m, to.ratio - from.ratio,
      to.track_width_m - from.track_width_m, to.latency_s - from.latency_s;
  return d;
}

void descend(const DriveData& data, const DriveUnknowns& start, State& s, Sizes& sizes) {
  constexpr int kIterations = 40;
  double lambda = 1e-2;
  for (int i = 0; i < kIterations; ++i) {
    sizes = sizes_of(data, s);
    const DriveVector off_prior = difference(start, s.unknowns);
    const double cost = cost_of(data, s, sizes, off_prior);
    const Normal full = normal_equations(data, s, sizes, off_prior);
    double gain = -1.0;
    for (int attempt = 0; attempt < 6 && gain < 0.0; ++attempt) {
      Normal n = full;
      n.H.diagonal() *= 1.0 + lambda;
      std::vector<Eigen::Matrix3d> inverse;
      eliminate(s, lambda, n, inverse);
      const Eigen::VectorXd step = n.H.selfadjointView<Eigen::Lower>().llt().solve(n.g);
      const State tried = moved(s, full, inverse, step);
      const double now = cost_of(data, tried, sizes, difference(start, tried.unknowns));
      if (std::isfinite(now) && now < cost) {
        gain = (cost - now) / cost;
        s = tried;
      }
      lambda = gain >= 0.0 ? std::max(1e-9, 0.1 * lambda) : 10.0 * lambda;
    }
    if (gain < 1e-6) break;
  }
}

}  // namespace

DriveUnknowns DriveUnknowns::moved(const DriveVector& step) const {
  DriveUnknowns out = *this;
  const double angle = step.head<3>().norm();
  if (angle > 1e-15) {
    out.R_base_camera *= Eigen::AngleAxisd(angle, step.head<3>() / angle).toRotationMatrix();
  }
  out.lever_m += step.segment<2>(3);
  out.ratio += step(5);
  out.track_width_m += step(6);
  out.latency_s += step(7);
  return out;
}

DriveSolution solve_drive(const DriveData& data, const DriveUnknowns& start) {
  State s = starting_state(data, start);
  DriveSolution out;
  if (s.points.empty()) {
    out.unknowns = start;
    out.covariance = kPriorSigma.cwiseAbs2().asDiagonal();
    out.poses = s.poses;
    return out;
  }
  Sizes sizes;
  descend(data, start, s, sizes);
  Normal n = normal_equations(data, s, sizes, difference(start, s.unknowns));
  std::vector<Eigen::Matrix3d> inverse;
  eliminate(s, 0.0, n, inverse);
  const Eigen::MatrixXd columns = n.H.selfadjointView<Eigen::Lower>().llt().solve(
      Eigen::MatrixXd::Identity(n.H.rows(), kDriveSize));
  out.unknowns = s.unknowns;
  out.covariance = columns.topRows<kDriveSize>();
  out.poses = s.poses;
  out.sight_sigma_rad = sizes.sight_rad;
  out.odometry_sigma = sizes.odometry;
  out.points = static_cast<int>(s.points.size());
  for (std::size_t p = 0; p < s.points.size(); ++p) {
    out.sightings += static_cast<int>(s.points[p].sightings.size());
    const double rho = s.points[p].state.z();
    if (std::sqrt(inverse[p](2, 2)) < 0.05 * rho) out.heights_m.push_back(1.0 / rho);
  }
  return out;
}

}  // namespace zenith::tools
