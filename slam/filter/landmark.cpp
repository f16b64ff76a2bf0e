#include "slam/filter/landmark.h"

#include <algorithm>
#include <cmath>

namespace zenith {
namespace {

// Least inverse height that is turned into metres: 20 m above the camera.
constexpr float kMinRho = 0.05F;

// What the observation of one particle needs: R(theta_a - theta_t) as (c, s), b, and m.
struct View {
  float c, s, bx, by, mx, my;
};

inline View view(const LandmarkRows& l, const CameraRows& camera, int i) {
  const float ct = camera.cos[i];
  const float st = camera.sin[i];
  const float c = l.anchor_cos[i] * ct + l.anchor_sin[i] * st;
  const float s = l.anchor_sin[i] * ct - l.anchor_cos[i] * st;
  const float dx = l.anchor_x[i] - camera.x[i];
  const float dy = l.anchor_y[i] - camera.y[i];
  const float bx = ct * dx + st * dy;
  const float by = ct * dy - st * dx;
  return {c,
          s,
          bx,
          by,
          c * l.ax[i] - s * l.ay[i] + l.rho[i] * bx,
          s * l.ax[i] + c * l.ay[i] + l.rho[i] * by};
}

// P H^T, a 3 x 2 matrix; H's rows are (c, -s, bx) and (s, c, by).
struct Gain {
  float x0, x1, y0, y1, r0, r1;
};

inline Gain covariance_times_h(const LandmarkRows& l, const View& v, int i) {
  return {l.pxx[i] * v.c - l.pxy[i] * v.s + l.pxr[i] * v.bx,
          l.pxx[i] * v.s + l.pxy[i] * v.c + l.pxr[i] * v.by,
          l.pxy[i] * v.c - l.pyy[i] * v.s + l.pyr[i] * v.bx,
          l.pxy[i] * v.s + l.pyy[i] * v.c + l.pyr[i] * v.by,
          l.pxr[i] * v.c - l.pyr[i] * v.s + l.prr[i] * v.bx,
          l.pxr[i] * v.s + l.pyr[i] * v.c + l.prr[i] * v.by};
}

struct Symmetric2 {
  float xx, xy, yy;
};

inline Symmetric2 innovation(const Gain& g, const View& v) {
  return {v.c * g.x0 - v.s * g.y0 + v.bx * g.r0, v.c * g.x1 - v.s * g.y1 + v.bx * g.r1,
          v.s * g.x1 + v.c * g.y1 + v.by * g.r1};
}

}  // namespace

LandmarkRows landmark_rows(LandmarkRowStore& landmarks, int slot, AnchorRowStore& anchors,
                           int anchor) {
  return {landmarks.row(slot, 0), landmarks.row(slot, 1), landmarks.row(slot, 2),
          landmarks.row(slot, 3), landmarks.row(slot, 4), landmarks.row(slot, 5),
          landmarks.row(slot, 6), landmarks.row(slot, 7), landmarks.row(slot, 8),
          anchors.row(anchor, 0), anchors.row(anchor, 1), anchors.row(anchor, 2),
          anchors.row(anchor, 3)};
}

void predict_landmark(const LandmarkRows& l, const CameraRows& camera, int particles,
                      const PredictionRows& out) {
  for (int i = 0; i < particles; ++i) {
    const View v = view(l, camera, i);
    const Symmetric2 s = innovation(covariance_times_h(l, v, i), v);
    out.mx[i] = v.mx;
    out.my[i] = v.my;
    out.sxx[i] = s.xx;
    out.sxy[i] = s.xy;
    out.syy[i] = s.yy;
  }
}

void update_landmark(const LandmarkRows& l, const CameraRows& camera, int particles, float zx,
                     float zy, float noise) {
  for (int i = 0; i < particles; ++i) {
    const View v = view(l, camera, i);
    const Gain g = covariance_times_h(l, v, i);
    Symmetric2 s = innovation(g, v);
    s.xx += noise;
    s.yy += noise;
    const float inverse_det = 1.0F / (s.xx * s.yy - s.xy * s.xy);
    const float wxx = s.yy * inverse_det;
    const float wxy = -s.xy * inverse_det;
    const float wyy = s.xx * inverse_det;
    const float nx = zx - v.mx;
    const float ny = zy - v.my;
    // K = P H^T S^-1
    const float kx0 = g.x0 * wxx + g.x1 * wxy;
    const float kx1 = g.x0 * wxy + g.x1 * wyy;
    const float ky0 = g.y0 * wxx + g.y1 * wxy;
    const float ky1 = g.y0 * wxy + g.y1 * wyy;
    const float kr0 = g.r0 * wxx + g.r1 * wxy;
    const float kr1 = g.r0 * wxy + g.r1 * wyy;
    l.ax[i] += kx0 * nx + kx1 * ny;
    l.ay[i] += ky0 * nx + ky1 * ny;
    l.rho[i] += kr0 * nx + kr1 * ny;
    // P -= K (P H^T)^T; the variances stay above a floor that rounding cannot cross.
    constexpr float kFloor = 1e-9F;
    l.pxx[i] = std::max(l.pxx[i] - (kx0 * g.x0 + kx1 * g.x1), kFloor);
    l.pxy[i] -= kx0 * g.y0 + kx1 * g.y1;
    l.pxr[i] -= kx0 * g.r0 + kx1 * g.r1;
    l.pyy[i] = std::max(l.pyy[i] - (ky0 * g.y0 + ky1 * g.y1), kFloor);
    l.pyr[i] -= ky0 * g.r0 + ky1 * g.r1;
    l.prr[i] = std::max(l.prr[i] - (kr0 * g.r0 + kr1 * g.r1), kFloor);
  }
}

void add_log_likelihood(const LandmarkRows& l, const CameraRows& camera, int particles, float zx,
                        float zy, float noise, float cap, double* log_likelihood) {
  for (int i = 0; i < particles; ++i) {
    const View v = view(l, camera, i);
    Symmetric2 s = innovation(covariance_times_h(l, v, i), v);
    s.xx += noise;
    s.yy += noise;
    const float det = s.xx * s.yy - s.xy * s.xy;
    const float nx = zx - v.mx;
    const float ny = zy - v.my;
    const float d2 = (s.yy * nx * nx - 2.0F * s.xy * nx * ny + s.xx * ny * ny) / det;
    log_likelihood[i] -= static_cast<double>(0.5F * (std::min(d2, cap) + std::log(det)));
  }
}

void start_landmark(const LandmarkRows& l, int particles, float zx, float zy, float noise,
                    float rho_mean, float rho_sigma) {
  for (int i = 0; i < particles; ++i) {
    l.ax[i] = zx;
    l.ay[i] = zy;
    l.rho[i] = rho_mean;
    l.pxx[i] = noise;
    l.pxy[i] = 0.0F;
    l.pxr[i] = 0.0F;
    l.pyy[i] = noise;
    l.pyr[i] = 0.0F;
    l.prr[i] = rho_sigma * rho_sigma;
  }
}

LandmarkPlace place_landmark(const LandmarkRows& l, const double* weight, int particles,
                             double camera_z_m) {
  LandmarkPlace place;
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  double rho2 = 0.0;
  // Deviations are summed around the first particle's place, so that no digits are lost far out.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  for (int i = 0; i < particles; ++i) {
    const double rho = std::max(l.rho[i], kMinRho);
    const double h = 1.0 / rho;
    const double ca = l.anchor_cos[i];
    const double sa = l.anchor_sin[i];
    const double ax = l.ax[i];
    const double ay = l.ay[i];
    const double ex = ca * ax - sa * ay;
    const double ey = sa * ax + ca * ay;
    const double anchor_x = l.anchor_x[i];
    const double anchor_y = l.anchor_y[i];
    const Eigen::Vector3d p(anchor_x + ex * h, anchor_y + ey * h, camera_z_m + h);
    if (i == 0) origin = p;
    // d L / d (ax, ay, rho)
    Eigen::Matrix3d J;
    J << ca * h, -sa * h, -ex * h * h, sa * h, ca * h, -ey * h * h, 0.0, 0.0, -h * h;
    Eigen::Matrix3d P;
    P << l.pxx[i], l.pxy[i], l.pxr[i], l.pxy[i], l.pyy[i], l.pyr[i], l.pxr[i], l.pyr[i], l.prr[i];
    const double w = weight[i];
    const Eigen::Vector3d d = p - origin;
    place.mean_m += w * d;
    second += w * (d * d.transpose() + J * P * J.transpose());
    const double rho_i = l.rho[i];
    place.rho += w * rho_i;
    rho2 += w * (rho_i * rho_i + P(2, 2));
  }
  place.covariance_m2 = second - place.mean_m * place.mean_m.transpose();
  place.mean_m += origin;
  place.rho_variance = rho2 - place.rho * place.rho;
  return place;
}

}  // namespace zenith
