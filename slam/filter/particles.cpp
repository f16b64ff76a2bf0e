#include "slam/filter/particles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slam/bounds.h"
#include "slam/counters.h"

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

namespace {

// Returns the sum of the weights, the largest being 1; no number when a log weight is none.
double weigh(std::span<double> log_weight, std::span<double> weight) {
  const double largest = *std::max_element(log_weight.begin(), log_weight.end());
  if (!std::isfinite(largest)) return largest;
  double sum = 0.0;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    log_weight[i] -= largest;
    weight[i] = std::exp(log_weight[i]);
    sum += weight[i];
  }
  return sum;
}

void repair(std::span<double> log_weight, RepairCounters& repairs) {
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  bool any = false;
  for (double& w : log_weight) {
    if (std::isfinite(w)) {
      any = true;
    } else if (w != kNone) {
      w = kNone;
      ++repairs.weights_zeroed;
    }
  }
  if (any) return;
  std::fill(log_weight.begin(), log_weight.end(), 0.0);
  ++repairs.weights_equalised;
}

}  // namespace

double normalise_weights(Particles& particles, RepairCounters& repairs) {
  const auto n = static_cast<std::size_t>(particles.count);
  const auto log_weight = particles.log_weight.first(n);
  const auto weight = particles.weight.first(n);
  double sum = weigh(log_weight, weight);
  if (!is_within(sum, static_cast<double>(n)) || sum < 1.0) {
    repair(log_weight, repairs);
    sum = weigh(log_weight, weight);
  }
  double squares = 0.0;
  for (double& w : weight) {
    w /= sum;
    squares += w * w;
  }
  return 1.0 / squares;
}

namespace {

// The heading from which the particles' headings add up to nothing.
double mean_heading(const Particles& particles) {
  double c = 0.0;
  double s = 0.0;
  for (int i = 0; i < particles.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    c += particles.weight[k] * std::cos(particles.theta_rad[k]);
    s += particles.weight[k] * std::sin(particles.theta_rad[k]);
  }
  const double direction = std::atan2(s, c);
  double off = 0.0;
  for (int i = 0; i < particles.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    off += particles.weight[k] * wrap_angle(particles.theta_rad[k] - direction);
  }
  return wrap_angle(direction + off);
}

// (phi / 2) cot(phi / 2) for phi in [-pi, pi].
double half_cotangent(double phi) {
  const double half = 0.5 * phi;
  const double square = half * half;
  if (square < 1e-3) return 1.0 - square / 3.0 - square * square / 45.0;
  return half / std::tan(half);
}

}  // namespace

PoseEstimate estimate_pose(const Particles& particles) {
  PoseEstimate estimate;
  estimate.mean.theta_rad = mean_heading(particles);
  const Pose2 near = particles.pose(0);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double scale = 0.0;
  for (int i = 0; i < particles.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double phi = wrap_angle(particles.theta_rad[k] - estimate.mean.theta_rad);
    const double a = half_cotangent(phi);
    const double x = particles.x_m[k] - near.x_m;
    const double y = particles.y_m[k] - near.y_m;
    sum += particles.weight[k] * Eigen::Vector2d(a * x + 0.5 * phi * y, a * y - 0.5 * phi * x);
    scale += particles.weight[k] * a;
  }
  estimate.mean.x_m = near.x_m + sum.x() / scale;
  estimate.mean.y_m = near.y_m + sum.y() / scale;
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
