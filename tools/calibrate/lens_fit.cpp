#include "tools/calibrate/lens_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "slam/image/lens_projection.h"
#include "tools/calibrate/median.h"

namespace zenith::tools {
namespace {

constexpr double kHuberSigmas = 1.5;
// Lenses that people mount have coefficients of a few hundredths.
constexpr double kDistortionPrior[4] = {0.3, 0.3, 0.3, 0.3};
constexpr int kPoseSize = 6;

struct Normal {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
};

double huber_cost(double norm, double limit) {
  return norm <= limit ? norm * norm : limit * (2.0 * norm - limit);
}

double prior_cost(const Lens& lens, double sigma) {
  double cost = 0.0;
  for (int i = 0; i < 4; ++i) {
    const double off = lens.k[static_cast<std::size_t>(i)] / kDistortionPrior[i];
    cost += off * off * sigma * sigma;
  }
  return cost;
}

double cost_of(const LensFit& fit, const std::vector<BoardView>& views, double sigma) {
  double cost = prior_cost(fit.lens, sigma);
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (const auto& r : residuals(fit.lens, fit.poses[i], views[i])) {
      cost += huber_cost(r.norm(), kHuberSigmas * sigma);
    }
  }
  return cost;
}

void add_view(const LensFit& fit, const BoardView& view, std::size_t index, double limit,
              Normal& n) {
  const BoardPose& pose = fit.poses[index];
  const auto at = static_cast<Eigen::Index>(kLensSize + kPoseSize * index);
  for (std::size_t c = 0; c < view.board_m.size(); ++c) {
    const Eigen::Vector3d turned = pose.R_camera_board.leftCols<2>() * view.board_m[c];
    const Projection p = project_with_derivatives(fit.lens, turned + pose.t_m);
    const Eigen::Vector2d r = view.seen_px[c] - p.uv_px;
    const double weight = std::min(1.0, limit / std::max(1e-12, r.norm()));
    Eigen::Matrix<double, 2, kPoseSize> by_pose;
    by_pose << -p.by_point * cross_matrix(turned), p.by_point;
    n.H.topLeftCorner<kLensSize, kLensSize>() += weight * p.by_lens.transpose() * p.by_lens;
    n.H.block<kLensSize, kPoseSize>(0, at) += weight * p.by_lens.transpose() * by_pose;
    n.H.block<kPoseSize, kPoseSize>(at, at) += weight * by_pose.transpose() * by_pose;
    n.g.head<kLensSize>() += weight * p.by_lens.transpose() * r;
    n.g.segment<kPoseSize>(at) += weight * by_pose.transpose() * r;
  }
}

Normal normal_equations(const LensFit& fit, const std::vector<BoardView>& views, double sigma) {
  const auto size = static_cast<Eigen::Index>(kLensSize + kPoseSize * views.size());
  Normal n{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
  for (std::size_t i = 0; i < views.size(); ++i) {
    add_view(fit, views[i], i, kHuberSigmas * sigma, n);
  }
  for (int i = 0; i < 4; ++i) {
    const double weight = std::pow(sigma / kDistortionPrior[i], 2.0);
    n.H(4 + i, 4 + i) += weight;
    n.g(4 + i) -= weight * fit.lens.k[static_cast<std::size_t>(i)];
  }
  n.H.triangularView<Eigen::StrictlyLower>() = n.H.transpose();
  return n;
}

LensFit moved(const LensFit& fit, const Eigen::VectorXd& step) {
  LensFit out = fit;
  out.lens = lens_of_vector(lens_vector(fit.lens) + step.head<kLensSize>(), fit.lens.width_px,
                            fit.lens.height_px);
  for (std::size_t i = 0; i < out.poses.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(kLensSize + kPoseSize * i);
    const Eigen::Vector3d turn = step.segment<3>(at);
    const double angle = turn.norm();
    if (angle > 1e-12) {
      out.poses[i].R_camera_board =
          Eigen::AngleAxisd(angle, turn / angle) * out.poses[i].R_camera_board;
    }
    out.poses[i].t_m += step.segment<3>(at + 3);
  }
  return out;
}

double sigma_of(const LensFit& fit, const std::vector<BoardView>& views) {
  std::vector<double> sizes;
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (const auto& r : residuals(fit.lens, fit.poses[i], views[i])) {
      sizes.push_back(std::abs(r.x()));
      sizes.push_back(std::abs(r.y()));
    }
  }
  return std::max(0.02, robust_sigma(std::move(sizes)));
}

// Descends with sigma found anew; returns the final cost by the last sigma.
void descend(LensFit& fit, const std::vector<BoardView>& views, int iterations) {
  double lambda = 1e-3;
  for (int i = 0; i < iterations; ++i) {
    const double sigma = sigma_of(fit, views);
    const double cost = cost_of(fit, views, sigma);
    const Normal n = normal_equations(fit, views, sigma);
    bool better = false;
    double gain = 0.0;
    for (int attempt = 0; attempt < 8 && !better; ++attempt) {
      Eigen::MatrixXd damped = n.H;
      damped.diagonal() *= 1.0 + lambda;
      const LensFit tried = moved(fit, damped.ldlt().solve(n.g));
      const double now = cost_of(tried, views, sigma);
      better = std::isfinite(now) && now < cost;
      if (better) {
        gain = (cost - now) / cost;
        fit = tried;
      }
      lambda = better ? std::max(1e-9, 0.2 * lambda) : 10.0 * lambda;
    }
    if (!better || gain < 1e-9) break;
  }
  fit.sigma_px = sigma_of(fit, views);
}

Lens equidistant(int width_px, int height_px, double focal_px) {
  return {width_px, height_px, focal_px, focal_px, 0.5 * (width_px - 1), 0.5 * (height_px - 1), {}};
}

std::optional<LensFit> start_from(const Lens& lens, const std::vector<BoardView>& views) {
  LensFit fit;
  fit.lens = lens;
  for (const BoardView& view : views) {
    const auto pose = pose_from_rays(lens, view);
    if (!pose) return std::nullopt;
    fit.poses.push_back(*pose);
  }
  return fit;
}

// A few views, spread over all, tell starts apart as well as all of them.
std::vector<BoardView> some_of(const std::vector<BoardView>& views) {
  constexpr std::size_t kMost = 8;
  if (views.size() <= kMost) return views;
  std::vector<BoardView> some;
  for (std::size_t i = 0; i < kMost; ++i) some.push_back(views[i * views.size() / kMost]);
  return some;
}

std::optional<Lens> best_start(const std::vector<BoardView>& views, int width_px, int height_px) {
  const std::vector<BoardView> some = some_of(views);
  std::optional<Lens> best;
  double least = 0.0;
  for (double share = 0.15; share < 1.3; share *= 1.3) {
    auto fit = start_from(equidistant(width_px, height_px, share * width_px), some);
    if (!fit) continue;
    descend(*fit, some, 15);
    if (best && fit->sigma_px >= least) continue;
    best = fit->lens;
    least = fit->sigma_px;
  }
  return best;
}

}  // namespace

std::optional<BoardPose> pose_from_rays(const Lens& lens, const BoardView& view) {
  const LensProjection projection(lens);
  const auto count = static_cast<Eigen::Index>(view.board_m.size());
  Eigen::MatrixXd A(3 * count, 9);
  std::vector<Eigen::Vector3d> rays;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& p : view.board_m) mean += p / static_cast<double>(count);
  double size = 1e-9;
  for (const auto& p : view.board_m) size = std::max(size, (p - mean).norm());
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector2d p = (view.board_m[static_cast<std::size_t>(i)] - mean) / size;
    const auto ray = projection.unproject(view.seen_px[static_cast<std::size_t>(i)]);
    if (!ray) return std::nullopt;
    rays.push_back(*ray);
    const Eigen::Matrix3d cross = cross_matrix(rays.back());
    A.block<3, 3>(3 * i, 0) = p.x() * cross;
    A.block<3, 3>(3 * i, 3) = p.y() * cross;
    A.block<3, 3>(3 * i, 6) = cross;
  }
  if (!A.allFinite()) return std::nullopt;
  const Eigen::Matrix<double, 9, 9> AtA = A.transpose() * A;
  const Eigen::JacobiSVD<Eigen::Matrix<double, 9, 9>> svd(AtA, Eigen::ComputeFullV);
  const Eigen::Matrix<double, 9, 1> h = svd.matrixV().col(8);
  Eigen::Matrix3d H;
  H << h.head<3>(), h.segment<3>(3), h.tail<3>();
  const double scale = std::sqrt(H.col(0).norm() * H.col(1).norm());
  if (scale < 1e-12) return std::nullopt;
  H /= scale;
  double ahead = 0.0;
  for (const auto& ray : rays) ahead += ray.dot(H.col(2));
  if (ahead < 0.0) H = -H;
  Eigen::Matrix3d R;
  R << H.col(0), H.col(1), H.col(0).cross(H.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> nearest(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  BoardPose pose;
  pose.R_camera_board = nearest.matrixU() * nearest.matrixV().transpose();
  if (pose.R_camera_board.determinant() < 0.0) return std::nullopt;
  pose.t_m = H.col(2) * size - pose.R_camera_board.leftCols<2>() * mean;
  return pose;
}

std::vector<Eigen::Vector2d> residuals(const Lens& lens, const BoardPose& pose,
                                       const BoardView& view) {
  std::vector<Eigen::Vector2d> out;
  out.reserve(view.board_m.size());
  for (std::size_t i = 0; i < view.board_m.size(); ++i) {
    out.push_back(view.seen_px[i] - project_equidistant(lens, pose.in_camera(view.board_m[i])));
  }
  return out;
}

double rms_of(const std::vector<Eigen::Vector2d>& residuals) {
  double sum = 0.0;
  for (const auto& r : residuals) sum += r.squaredNorm();
  return residuals.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(residuals.size()));
}

std::optional<LensFit> fit_lens(const std::vector<BoardView>& views, int width_px, int height_px) {
  if (views.size() < 3) return std::nullopt;
  const auto start = best_start(views, width_px, height_px);
  if (!start) return std::nullopt;
  auto fit = start_from(*start, views);
  if (!fit) return std::nullopt;
  descend(*fit, views, 60);
  const Normal n = normal_equations(*fit, views, fit->sigma_px);
  const Eigen::MatrixXd inverse =
      n.H.ldlt().solve(Eigen::MatrixXd::Identity(n.H.rows(), kLensSize));
  fit->covariance = fit->sigma_px * fit->sigma_px * inverse.topRows<kLensSize>();
  return fit;
}

}  // namespace zenith::tools
