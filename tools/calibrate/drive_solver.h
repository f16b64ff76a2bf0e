#pragma once
// Mount and wheels from a drive: all poses, all points of the ceiling and the unknowns together.
//
//   seen:    R_bc^T [R(theta_t)^T (a + rho (c0 - p_t)) - rho l, 1]   the direction of a point
//   driven:  T_i^-1 T_i+1 = arc(sl dL, sr dR, b)                     travel at stamps + latency
//
// a and rho: direction and inverse height of a point from the place c0 whence it was first seen,
// above the camera; l: the lever arm; p, theta: base_link. Minimised are the whitened errors under
// Cauchy's loss, by Levenberg and Marquardt's method with the points eliminated first (Schur
// complement; Triggs et al., "Bundle adjustment", 1999). The errors' sizes are found on the way.
//
// One camera sees no scale: all lengths follow from the mean of both wheels' scales, which stays.

#include <vector>

#include <Eigen/Core>

#include "tools/calibrate/drive_data.h"

namespace zenith::tools {

inline constexpr int kDriveSize = 8;
// Turn of the camera about its own axes (3), lever arm (2), ratio, track width, latency.
using DriveVector = Eigen::Matrix<double, kDriveSize, 1>;
using DriveMatrix = Eigen::Matrix<double, kDriveSize, kDriveSize>;

struct DriveUnknowns {
  Eigen::Matrix3d R_base_camera = Eigen::Matrix3d::Identity();
  Eigen::Vector2d lever_m = Eigen::Vector2d::Zero();
  double ratio = 0.0;  // (left - right) / mean of the scales
  double scale = 1.0;  // mean of the scales: stays
  double track_width_m = 0.4;
  double latency_s = 0.0;  // the wheels' frames are late by this

  Wheels wheels() const {
    return {track_width_m, scale * (1.0 + 0.5 * ratio), scale * (1.0 - 0.5 * ratio)};
  }
  DriveUnknowns moved(const DriveVector& step) const;
};

struct DriveSolution {
  DriveUnknowns unknowns;
  DriveMatrix covariance = DriveMatrix::Zero();
  std::vector<Pose2> poses;       // T_start_robot by frame
  std::vector<double> heights_m;  // of well known points above the camera
  double sight_sigma_rad = 0.0;
  double odometry_sigma = 0.0;  // 1: as noisy as assumed
  int points = 0;
  int sightings = 0;
};

// A start from the directions alone: leaning by the axis of turns, yaw by the direction of straight
// ways. Where the drive shows neither, what was believed.
DriveUnknowns start_of_drive(const DriveData& data);

DriveSolution solve_drive(const DriveData& data, const DriveUnknowns& start);

}  // namespace zenith::tools
