#include "slam/filter/landmark.h"

namespace zenith {
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
  rows_in_use().predict(l, camera, particles, out);
}

LandmarkPrediction predict_landmark(const LandmarkRows& l, const CameraRows& camera,
                                    const double* weight, int particles) {
  const PredictionSums s = rows_in_use().predict_sums(l, camera, weight, particles);
  LandmarkPrediction out;
  out.mean = {s.mx, s.my};
  out.spread << s.mxx, s.mxy, s.mxy, s.myy;
  out.spread -= out.mean * out.mean.transpose();
  out.own << s.sxx, s.sxy, s.sxy, s.syy;
  out.rho = s.rho;
  return out;
}

Eigen::Vector2d depth_covariance(const LandmarkRows& l, const CameraRows& camera, int i) {
  const double c = l.anchor_cos[i] * camera.cos[i] + l.anchor_sin[i] * camera.sin[i];
  const double s = l.anchor_sin[i] * camera.cos[i] - l.anchor_cos[i] * camera.sin[i];
  const double dx = l.anchor_x[i] - camera.x[i];
  const double dy = l.anchor_y[i] - camera.y[i];
  const double bx = camera.cos[i] * dx + camera.sin[i] * dy;
  const double by = camera.cos[i] * dy - camera.sin[i] * dx;
  const double pxr = l.pxr[i];
  const double pyr = l.pyr[i];
  const double prr = l.prr[i];
  return {pxr * c - pyr * s + prr * bx, pxr * s + pyr * c + prr * by};
}

void update_landmark(const LandmarkRows& l, const CameraRows& camera, int particles, float zx,
                     float zy, float noise) {
  rows_in_use().update(l, camera, particles, {zx, zy, noise});
}

void add_log_likelihood(const LandmarkRows& l, const CameraRows& camera, int particles,
                        const Sight& sight, float cap, double* log_likelihood) {
  rows_in_use().add_log_likelihood(l, camera, particles, sight, cap, log_likelihood);
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
  const PlaceSums s = rows_in_use().place_sums(l, weight, particles, kLeastRho);
  LandmarkPlace place;
  const Eigen::Vector3d d(s.mean[0], s.mean[1], s.mean[2]);
  place.covariance_m2 << s.second[0], s.second[1], s.second[2], s.second[1], s.second[3],
      s.second[4], s.second[2], s.second[4], s.second[5];
  place.covariance_m2 -= d * d.transpose();
  place.mean_m = d + Eigen::Vector3d(s.origin[0], s.origin[1], s.origin[2] + camera_z_m);
  place.rho = s.rho;
  place.rho_variance = s.rho2 - s.rho * s.rho;
  return place;
}

}  // namespace zenith
