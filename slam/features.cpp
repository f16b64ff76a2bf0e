#include "slam/features.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "slam/image/view.h"

namespace zenith {
namespace {

constexpr double kWeakestThreshold = 0.15;  // below, everything is noise
constexpr double kFewCorners = 0.55;        // of corners_max
constexpr double kEnoughCorners = 0.75;
constexpr double kThresholdStep = 0.8;

}  // namespace

void FeatureExtractor::layout(Arena& arena) {
  arena.part("image: rectification, corners, patches");
  rectifier_.layout(arena);
  detector_.layout(arena);
  rectified_ = arena.take<std::uint8_t>(kRectifiedSize * kRectifiedSize);
  rectified_before_ = arena.take<std::uint8_t>(kRectifiedSize * kRectifiedSize);
  corners_ = arena.take<Corners>(1);
  features_ = arena.take<Features>(1);
}

void FeatureExtractor::build(const RobotConfig& robot, const Parameters& parameters) {
  pinhole_ = Pinhole::from_fov(with_fitted_view(parameters, robot).rectified_fov_deg *
                               std::numbers::pi / 180.0);
  settings_.min_eigenvalue = parameters.corner_min_eigenvalue;
  settings_.min_distance_px = parameters.corner_min_distance_px;
  settings_.max_corners = parameters.corners_max;
  strongest_threshold_ = settings_.min_eigenvalue;
  rectifier_.build(robot.lens, robot.mount, pinhole_);
}

void FeatureExtractor::adapt_threshold(std::size_t corners, int wanted) {
  const auto count = static_cast<double>(corners);
  double& threshold = settings_.min_eigenvalue;
  if (count < kFewCorners * wanted) {
    threshold =
        std::max(threshold * kThresholdStep, std::min(kWeakestThreshold, strongest_threshold_));
  } else if (count > kEnoughCorners * wanted) {
    threshold = std::min(threshold / kThresholdStep, strongest_threshold_);
  }
}

bool FeatureExtractor::sees(const Eigen::Vector2d& m, int margin_px) const {
  const Eigen::Vector2d at = pinhole_.pixel(m);
  if (!(at.array().abs() < 1e6).all()) return false;
  return rectifier_.sees(static_cast<int>(std::lround(at.x())),
                         static_cast<int>(std::lround(at.y())), margin_px);
}

Features& FeatureExtractor::extract(const ImageView& frame, int corners_max) {
  Corners& corners = corners_[0];
  Features& features = features_[0];
  std::swap(rectified_, rectified_before_);
  const MutableImageView image = {rectified_.data(), kRectifiedSize, kRectifiedSize,
                                  kRectifiedSize};
  rectifier_.apply(frame, image);
  repeated_ = !features.empty() &&
              std::equal(rectified_.begin(), rectified_.end(), rectified_before_.begin());
  if (repeated_) return features;
  features.clear();
  CornerSettings settings = settings_;
  settings.max_corners = std::clamp(corners_max, 0, settings.max_corners);
  detector_.detect(image, settings, corners);
  adapt_threshold(corners.size(), settings.max_corners);
  for (const Corner& corner : corners) {
    const int u = static_cast<int>(std::lround(corner.u_px));
    const int v = static_cast<int>(std::lround(corner.v_px));
    if (!rectifier_.sees(u, v, settings_.border_px)) continue;
    Feature f;
    const Eigen::Vector2d m = pinhole_.normalise(corner.u_px, corner.v_px);
    f.zx = static_cast<float>(m.x());
    f.zy = static_cast<float>(m.y());
    f.u_px = corner.u_px;
    f.v_px = corner.v_px;
    f.orientation_rad = patch_orientation(image, corner.u_px, corner.v_px);
    f.patch = sample_patch(image, corner.u_px, corner.v_px, f.orientation_rad);
    f.compact = compact(f.patch);
    f.described = f.patch.inverse_norm > 0.0F;
    features.push_back(f);
  }
  return features;
}

}  // namespace zenith
