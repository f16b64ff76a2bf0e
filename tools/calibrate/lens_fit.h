#pragma once
// The lens and the boards' poses that explain where corners were seen best.
//
//   minimise  sum over corners of rho(|project(lens, R_i X + t_i) - seen|) + weak prior on k
//
// by Levenberg and Marquardt's method, rho Huber's: squares for errors below 1.5 sigma, then lines.
// The poses start from a homography between the board and the rays of its corners (Hartley,
// Zisserman, "Multiple View Geometry", 4.1), which knows no horizon: rays at 90 degrees and more
// are ordinary ones. The lens starts as the best of some equidistant ones.

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "tools/calibrate/projection.h"

namespace zenith::tools {

// One image of a board: at least kLeastCorners corners, in the board's and the image's frame.
struct BoardView {
  std::vector<Eigen::Vector2d> board_m;
  std::vector<Eigen::Vector2d> seen_px;
};

struct BoardPose {
  Eigen::Matrix3d R_camera_board = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t_m = Eigen::Vector3d::Zero();

  Eigen::Vector3d in_camera(const Eigen::Vector2d& board_m) const {
    return R_camera_board.leftCols<2>() * board_m + t_m;
  }
};

struct LensFit {
  Lens lens;
  std::vector<BoardPose> poses;  // as the views
  double sigma_px = 0.0;         // of a corner's coordinate, robustly
  LensMatrix covariance = LensMatrix::Zero();
};

// Pose of a board that this lens saw; none when the corners fit no plane.
std::optional<BoardPose> pose_from_rays(const Lens& lens, const BoardView& view);

// Of one view; the differences seen - projected.
std::vector<Eigen::Vector2d> residuals(const Lens& lens, const BoardPose& pose,
                                       const BoardView& view);
double rms_of(const std::vector<Eigen::Vector2d>& residuals);

// None when no start leads anywhere. Time grows with the cube of the number of views.
std::optional<LensFit> fit_lens(const std::vector<BoardView>& views, int width_px, int height_px);

}  // namespace zenith::tools
