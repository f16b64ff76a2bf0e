#pragma once
// The fisheye lens, Kannala-Brandt ("equidistant" in Kalibr and OpenCV).
//
//   theta   = atan2(|(X, Y)|, Z)                      angle between the ray and the optical axis
//   theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
//   u = fu theta_d X / |(X, Y)| + cu,   v = fv theta_d Y / |(X, Y)| + cv
//
// Source: Kannala, Brandt, "A generic camera model and calibration method for conventional,
// wide-angle, and fish-eye lenses", PAMI 2006. atan2 and not X/Z: rays at 90 degrees and more from
// the axis are ordinary rays here.
//
// Camera frame: z out of the lens, x along u (columns), y along v (rows).

#include <array>
#include <cmath>

#include <Eigen/Core>

namespace zenith {

struct Lens {
  int width_px = 640;
  int height_px = 480;
  double fu_px = 150.0;
  double fv_px = 150.0;
  double cu_px = 320.0;
  double cv_px = 240.0;
  std::array<double, 4> k = {0.0, 0.0, 0.0, 0.0};

  double distort(double theta_rad) const {
    const double t2 = theta_rad * theta_rad;
    return theta_rad * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
  }

  // Pixel coordinates (u, v) of a ray in the camera frame; the ray needs no unit length.
  Eigen::Vector2d project(const Eigen::Vector3d& ray) const {
    const double r = std::hypot(ray.x(), ray.y());
    if (r < 1e-12) return {cu_px, cv_px};
    const double scale = distort(std::atan2(r, ray.z())) / r;
    return {fu_px * scale * ray.x() + cu_px, fv_px * scale * ray.y() + cv_px};
  }

  // Unit ray in the camera frame of a pixel: the inverse of project(), by Newton's method.
  Eigen::Vector3d unproject(const Eigen::Vector2d& uv) const {
    const double mx = (uv.x() - cu_px) / fu_px;
    const double my = (uv.y() - cv_px) / fv_px;
    const double theta_d = std::hypot(mx, my);
    if (theta_d < 1e-12) return {0.0, 0.0, 1.0};
    double theta = theta_d;
    for (int i = 0; i < 12; ++i) {
      const double t2 = theta * theta;
      const double slope =
          1.0 + t2 * (3.0 * k[0] + t2 * (5.0 * k[1] + t2 * (7.0 * k[2] + t2 * 9.0 * k[3])));
      if (std::abs(slope) < 1e-9) break;
      theta -= (distort(theta) - theta_d) / slope;
    }
    const double s = std::sin(theta) / theta_d;
    return {mx * s, my * s, std::cos(theta)};
  }
};

}  // namespace zenith
