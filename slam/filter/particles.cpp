#include "slam/filter/particles.h"

#include <algorithm>
#include <cassert>

namespace zenith {

void place_cameras(Particles& particles, const Eigen::Vector2d& lever_m) {
  for (int i = 0; i < particles.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double c = std::cos(particles.theta_rad[k]);
    const double s = std::sin(particles.theta_rad[k]);
    const double x = particles.x_m[k] + c * lever_m.x() - s * lever_m.y();
    const double y = particles.y_m[k] + s * lever_m.x() + c * lever_m.y();
    particles.camera.x[i] = static_cast<float>(x);
    particles.camera.y[i] = static_cast<float>(y);
    particles.camera.cos[i] = static_cast<float>(c);
    particles.camera.sin[i] = static_cast<float>(s);
  }
}

double normalise_weights(Particles& particles) {
  const auto n = static_cast<std::size_t>(particles.count);
  const auto log_weight = particles.log_weight.first(n);
  const auto weight = particles.weight.first(n);
  const double largest = *std::max_element(log_weight.begin(), log_weight.end());
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    log_weight[i] -= largest;
    weight[i] = std::exp(log_weight[i]);
    sum += weight[i];
  }
  assert(sum >= 1.0);
  double squares = 0.0;
  for (double& w : weight) {
    w /= sum;
    squares += w * w;
  }
  return 1.0 / squares;
}

PoseEstimate estimate_pose(const Particles& particles) {
  PoseEstimate estimate;
  double c = 0.0;
  double s = 0.0;
  for (int i = 0; i < particles.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    estimate.mean.x_m += particles.weight[k] * particles.x_m[k];
    estimate.mean.y_m += particles.weight[k] * particles.y_m[k];
    c += particles.weight[k] * std::cos(particles.theta_rad[k]);
    s += particles.weight[k] * std::sin(particles.theta_rad[k]);
  }
  estimate.mean.theta_rad = std::atan2(s, c);
  for (int i = 0; i < particles.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Eigen::Vector3d d(particles.x_m[k] - estimate.mean.x_m,
                            particles.y_m[k] - estimate.mean.y_m,
                            wrap_angle(particles.theta_rad[k] - estimate.mean.theta_rad));
    estimate.covariance += particles.weight[k] * d * d.transpose();
  }
  return estimate;
}

}  // namespace zenith
