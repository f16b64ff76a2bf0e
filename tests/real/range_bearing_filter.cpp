#include "tests/real/range_bearing_filter.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <Eigen/LU>

#include "slam/filter/resample.h"

namespace zenith {

RangeBearingFilter::RangeBearingFilter(const RangeBearingSettings& settings, std::uint64_t seed)
    : settings_(settings), random_(seed) {
  Arena counting;
  layout(counting);
  memory_.resize(counting.used() + Arena::kAlignment);
  void* start = memory_.data();
  std::size_t space = memory_.size();
  std::align(Arena::kAlignment, counting.used(), start, space);
  Arena arena({static_cast<std::byte*>(start), counting.used()});
  layout(arena);
  std::fill(particles_.log_weight.begin(), particles_.log_weight.end(), 0.0);
  normalise_weights(particles_, repairs_);
}

void RangeBearingFilter::layout(Arena& arena) {
  particles_.layout(arena, settings_.particles);
  ancestry_.layout(arena, settings_.particles);
  rows_.layout(arena, kLandmarks, settings_.particles);
  proposal_.layout(arena, settings_.particles);
}

void RangeBearingFilter::drive(double forward_mps, double turn_radps, double dt_s) {
  const double metres = forward_mps * dt_s;
  const double radians = turn_radps * dt_s;
  const double half = 0.5 * radians;
  const double chord = std::abs(half) < 1e-9 ? metres : metres * std::sin(half) / half;
  const Pose2 step = {chord * std::cos(half), chord * std::sin(half), radians};
  // An error before the step, seen in the body after it: the adjoint of the step's inverse.
  const Pose2 back = step.inverse();
  Eigen::Matrix3d adjoint = Eigen::Matrix3d::Identity();
  adjoint.topLeftCorner<2, 2>() = rotation(back.theta_rad);
  adjoint(0, 2) = back.y_m;
  adjoint(1, 2) = -back.x_m;
  const auto variance = [](double sigma, double amount) {
    return sigma * sigma * std::abs(amount);
  };
  const Eigen::Vector3d noise(
      variance(settings_.forward_per_sqrt_m, metres),
      variance(settings_.lateral_per_sqrt_m, metres),
      variance(settings_.turn_per_sqrt_rad, radians) + variance(settings_.turn_per_sqrt_m, metres));
  motion_.mean = motion_.mean * step;
  motion_.covariance = adjoint * motion_.covariance * adjoint.transpose();
  motion_.covariance.diagonal() += noise;
}

// One particle's view of a landmark: what was measured less what was expected, and derivatives.
struct RangeBearingFilter::Innovation {
  Eigen::Vector2d difference;
  Eigen::Matrix2d H;              // by L in the world
  Eigen::Matrix<double, 2, 3> G;  // by xi in the body
  Eigen::Matrix2d P;
  Eigen::Matrix2d S;  // with measurement noise
};

RangeBearingFilter::Innovation RangeBearingFilter::innovation(const RangeBearing& z,
                                                              int particle) const {
  const int slot = z.subject;
  const Pose2 pose = particles_.pose(particle);
  const auto value = [&](int r) { return static_cast<double>(rows_.row(slot, r)[particle]); };
  const Eigen::Vector2d d = pose.inverse() * Eigen::Vector2d(value(0), value(1));
  const double range = std::max(d.norm(), 1e-3);
  Eigen::Matrix2d by_d;
  by_d << d.x() / range, d.y() / range, -d.y() / (range * range), d.x() / (range * range);
  Eigen::Matrix<double, 2, 3> d_by_xi;
  d_by_xi << -1.0, 0.0, d.y(), 0.0, -1.0, -d.x();

  Innovation out;
  out.difference = {z.range_m - range, wrap_angle(z.bearing_rad - std::atan2(d.y(), d.x()))};
  out.H = by_d * rotation(pose.theta_rad).transpose();
  out.G = by_d * d_by_xi;
  out.P << value(2), value(3), value(3), value(4);
  out.S = out.H * out.P * out.H.transpose();
  out.S(0, 0) += range_sigma(z) * range_sigma(z);
  out.S(1, 1) += settings_.bearing_sigma_rad * settings_.bearing_sigma_rad;
  return out;
}

// Squared Mahalanobis distance of a measurement from what all particles together expect: their
// spread, each one's landmark, noise, and what the odometry does not know when it is not drawn yet.
double RangeBearingFilter::distance_to_all(const RangeBearing& z) const {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  for (int i = 0; i < particles_.count; ++i) {
    const double w = particles_.weight[static_cast<std::size_t>(i)];
    const Innovation v = innovation(z, i);
    mean += w * v.difference;
    second += w * (v.S + v.difference * v.difference.transpose());
    if (settings_.optimal_proposal) second += w * (v.G * motion_.covariance * v.G.transpose());
  }
  const Eigen::Matrix2d S = second - mean * mean.transpose();
  return mean.dot(S.inverse() * mean);
}

// Measurements of landmarks that stand already, and that the particles together can believe. Of a
// young landmark the landmark is doubted and starts anew: its code was perhaps misread at first.
std::vector<RangeBearing> RangeBearingFilter::known_and_plausible(
    const std::vector<RangeBearing>& measurements) {
  std::vector<RangeBearing> known;
  for (const RangeBearing& z : measurements) {
    int& observations = observations_[static_cast<std::size_t>(z.subject)];
    if (observations == 0) continue;
    if (distance_to_all(z) < settings_.gate_d2) {
      known.push_back(z);
      continue;
    }
    ++gated_;
    if (observations < settings_.young) observations = 0;
  }
  return known;
}

void RangeBearingFilter::move_optimal(const std::vector<RangeBearing>& known) {
  proposal_.clear(particles_.count);
  for (const RangeBearing& z : known) {
    for (int i = 0; i < particles_.count; ++i) {
      const Innovation v = innovation(z, i);
      const Eigen::Matrix2d W = v.S.inverse();
      const Eigen::Matrix3d lambda = v.G.transpose() * W * v.G;
      const Eigen::Vector3d eta = v.G.transpose() * W * v.difference;
      const std::array<double, ProposalRows::kRows> add = {lambda(0, 0),
                                                           lambda(0, 1),
                                                           lambda(0, 2),
                                                           lambda(1, 1),
                                                           lambda(1, 2),
                                                           lambda(2, 2),
                                                           eta(0),
                                                           eta(1),
                                                           eta(2),
                                                           v.difference.dot(W * v.difference),
                                                           std::log(v.S.determinant())};
      for (std::size_t r = 0; r < add.size(); ++r) {
        proposal_.row[r][i] += static_cast<float>(add[r]);
      }
    }
  }
  draw_from_proposal(particles_, motion_.covariance, proposal_, random_);
}

void RangeBearingFilter::move_and_weigh(const std::vector<RangeBearing>& known) {
  for (const RangeBearing& z : known) {
    for (int i = 0; i < particles_.count; ++i) {
      const Innovation v = innovation(z, i);
      const double d2 = v.difference.dot(v.S.inverse() * v.difference);
      particles_.log_weight[static_cast<std::size_t>(i)] -=
          0.5 * (d2 + std::log(v.S.determinant()));
    }
  }
}

void RangeBearingFilter::observe(const std::vector<RangeBearing>& measurements) {
  for (const RangeBearing& z : measurements) rows_.bring(z.subject, ancestry_);
  move_by_mean(particles_, motion_.mean);
  if (settings_.optimal_proposal) {
    const auto known = known_and_plausible(measurements);
    move_optimal(known);
    for (const RangeBearing& z : known) update(z);
  } else {
    draw_from_motion(particles_, motion_.covariance, random_);
    const auto known = known_and_plausible(measurements);
    move_and_weigh(known);
    for (const RangeBearing& z : known) update(z);
  }
  motion_ = {};
  for (const RangeBearing& z : measurements) {
    if (observations_[static_cast<std::size_t>(z.subject)] == 0) start(z);
  }
  const double effective = normalise_weights(particles_, repairs_);
  if (effective < settings_.resample_fraction * particles_.count) resample();
}

void RangeBearingFilter::update(const RangeBearing& z) {
  for (int i = 0; i < particles_.count; ++i) {
    const Innovation v = innovation(z, i);
    const Eigen::Matrix2d K = v.P * v.H.transpose() * v.S.inverse();
    const Eigen::Vector2d step = K * v.difference;
    const Eigen::Matrix2d P = v.P - K * v.H * v.P;
    rows_.row(z.subject, 0)[i] += static_cast<float>(step.x());
    rows_.row(z.subject, 1)[i] += static_cast<float>(step.y());
    rows_.row(z.subject, 2)[i] = static_cast<float>(P(0, 0));
    rows_.row(z.subject, 3)[i] = static_cast<float>(0.5 * (P(0, 1) + P(1, 0)));
    rows_.row(z.subject, 4)[i] = static_cast<float>(P(1, 1));
  }
  ++observations_[static_cast<std::size_t>(z.subject)];
}

void RangeBearingFilter::start(const RangeBearing& z) {
  const double across = settings_.bearing_sigma_rad * z.range_m;
  const Eigen::Vector2d variance(range_sigma(z) * range_sigma(z), across * across);
  for (int i = 0; i < particles_.count; ++i) {
    const Pose2 sight = particles_.pose(i) * Pose2{0.0, 0.0, z.bearing_rad};
    const Eigen::Vector2d L = sight * Eigen::Vector2d(z.range_m, 0.0);
    const Eigen::Matrix2d R = rotation(sight.theta_rad);
    const Eigen::Matrix2d P = R * variance.asDiagonal() * R.transpose();
    const std::array<double, kRows> values = {L.x(), L.y(), P(0, 0), P(0, 1), P(1, 1)};
    for (int r = 0; r < kRows; ++r) {
      rows_.row(z.subject, r)[i] = static_cast<float>(values[static_cast<std::size_t>(r)]);
    }
  }
  rows_.set_generation(z.subject, ancestry_.generation());
  observations_[static_cast<std::size_t>(z.subject)] = 1;
}

void RangeBearingFilter::resample() {
  const auto n = static_cast<std::size_t>(particles_.count);
  std::vector<std::uint16_t> parents(n);
  systematic_resample(particles_.weight.first(n), random_.uniform(), parents);
  std::vector<Pose2> poses(n);
  for (std::size_t i = 0; i < n; ++i) poses[i] = particles_.pose(parents[i]);
  for (std::size_t i = 0; i < n; ++i) {
    particles_.set_pose(static_cast<int>(i), poses[i]);
    particles_.log_weight[i] = 0.0;
  }
  normalise_weights(particles_, repairs_);
  ancestry_.push(parents);
  // Rows that nobody touches must not outlive the ancestry's memory.
  for (int slot = 0; slot < kLandmarks; ++slot) {
    const bool old = ancestry_.generation() - rows_.generation(slot) > Ancestry::kGenerations / 2;
    if (old) rows_.bring(slot, ancestry_);
  }
}

std::vector<RangeBearingFilter::Landmark> RangeBearingFilter::landmarks() {
  std::vector<Landmark> out;
  for (int subject = 0; subject < kLandmarks; ++subject) {
    const int observations = observations_[static_cast<std::size_t>(subject)];
    if (observations == 0) continue;
    rows_.bring(subject, ancestry_);
    Landmark landmark{subject, Eigen::Vector2d::Zero(), Eigen::Matrix2d::Zero(), observations};
    Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
    for (int i = 0; i < particles_.count; ++i) {
      const double w = particles_.weight[static_cast<std::size_t>(i)];
      const auto value = [&](int r) { return static_cast<double>(rows_.row(subject, r)[i]); };
      const Eigen::Vector2d L(value(0), value(1));
      Eigen::Matrix2d P;
      P << value(2), value(3), value(3), value(4);
      landmark.mean_m += w * L;
      second += w * (P + L * L.transpose());
    }
    landmark.covariance_m2 = second - landmark.mean_m * landmark.mean_m.transpose();
    out.push_back(landmark);
  }
  return out;
}

}  // namespace zenith
