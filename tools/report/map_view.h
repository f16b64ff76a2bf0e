#pragma once
// How the map lies on the page.

#include <vector>

#include <Eigen/Core>

#include "tools/report/map_layout.h"

namespace zenith::tools {

inline constexpr int kMapWidth_px = 1600;
inline constexpr int kMapMargin_px = 60;
inline constexpr int kMapHeader_px = 120;

// From metres to pixels.
class MapView {
 public:
  // `legend_px`: room below the map.
  MapView(const MapLayout& layout, int legend_px);

  Eigen::Vector2d operator()(const Eigen::Vector2d& p) const {
    return middle_px_ + linear() * (p - middle_m_);
  }
  Eigen::Matrix2d covariance(const Eigen::Matrix2d& P) const {
    return linear() * P * linear().transpose();
  }
  std::vector<Eigen::Vector2d> operator()(const std::vector<Eigen::Vector2d>& points) const {
    std::vector<Eigen::Vector2d> mapped;
    for (const Eigen::Vector2d& point : points) mapped.push_back((*this)(point));
    return mapped;
  }
  double scale() const { return scale_; }
  int height_px() const { return height_px_; }
  double map_end_px() const { return kMapHeader_px + map_px_; }

 private:
  // y points up on the page.
  Eigen::Matrix2d linear() const {
    return scale_ * Eigen::Vector2d(1.0, -1.0).asDiagonal() * turn_;
  }

  Eigen::Matrix2d turn_;
  double scale_ = 1.0;
  int map_px_ = 0;
  int height_px_ = 0;
  Eigen::Vector2d middle_m_;
  Eigen::Vector2d middle_px_;
};

}  // namespace zenith::tools
