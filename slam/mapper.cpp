#include "slam/mapper.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "slam/filter/resample.h"
#include "slam/image/lens_projection.h"
#include "slam/image/view.h"

namespace zenith {
namespace {

// From the body's axes to those of the start, over (x, y, theta).
Eigen::Matrix3d turned(double heading_rad) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(heading_rad);
  return R;
}

}  // namespace

void Mapper::layout(Arena& arena, const Parameters& parameters) {
  const int n = std::min(parameters.particles, kMaxParticles);
  own_map_.layout(arena, n);
  arena.part("filter: particles, proposal, association");
  particles_.layout(arena, n);
  associator_.layout(arena);
  search_.layout(arena);
  closing_search_.layout(arena);
  before_ = arena.take<Pose2>(static_cast<std::size_t>(n));
  proposal_.layout(arena, n);
  const auto stride = static_cast<std::size_t>(row_stride(n));
  candidates_ = arena.take<Candidates>(1);
  parents_ = arena.take<std::uint16_t>(static_cast<std::size_t>(n));
  resample_scratch_ = arena.take<double>(stride);
}

void Mapper::build(const RobotConfig& robot, const Parameters& parameters, std::uint64_t seed) {
  robot_ = robot;
  p_ = with_fitted_view(parameters, robot);
  random_ = Random(seed, 1);
  const double f = Pinhole::from_fov(p_.rectified_fov_deg * kDegree).focal_px;
  const LensProjection projection(robot.lens);
  const double slope = projection.axis_slope();
  growth_ = pixel_growth(projection, p_.rectified_fov_deg);
  noise_ = static_cast<float>(p_.pixel_sigma_px * p_.pixel_sigma_px /
                              (robot.lens.fu_px * robot.lens.fv_px * slope * slope));
  association_.gate_sigma = p_.gate_sigma;
  association_.ncc_min = static_cast<float>(p_.ncc_match);
  pixel_ = 1.0 / f;
  depth_prior_ =
      DepthPrior::between(p_.min_height_m - robot_.mount.z_m, p_.max_height_m - robot_.mount.z_m);
  association_.min_radius = 1.5 * pixel_;
  closing_search_.build(p_);
  map_ = &own_map_;
  map_->reset();
  noise_scale_.reset();
  drift_ = {};
  map_errors_ = {p_.wheel_scale_sigma, p_.mount_yaw_sigma_deg * kDegree};
  calibration_.reset({p_.tilt_sigma_deg * kDegree, p_.focal_sigma,
                      p_.principal_sigma_px / (robot.lens.fu_px * slope)});
  const auto n = static_cast<std::size_t>(particles_.count);
  std::fill_n(particles_.weight.begin(), n, 1.0 / static_cast<double>(n));
  place_cameras(particles_, lever_m());
  effective_ = static_cast<double>(n);
}

bool Mapper::worth_using(const MotionIncrement& moved) const {
  const Pose2& m = moved.mean;
  return first_ || std::hypot(m.x_m, m.y_m) >= p_.min_travel_m ||
         std::abs(m.theta_rad) >= p_.min_turn_deg * kDegree;
}

void Mapper::update(const MotionIncrement& moved, Features& features,
                    const FeatureExtractor& view) {
  move(moved, features);
  forget_unseen();
  if (!follow(features, view)) return hold();
  weigh(features);
  estimate();
  keep_corners(features);
  for (const Candidate& c : candidates_[0]) {
    if (!c.inlier) continue;
    const Feature& f = features[static_cast<std::size_t>(c.corner)];
    const Eigen::Vector2f z = seen_at(c, f);
    update_landmark(map_->rows(c.slot), particles_.camera, particles_.count, z.x(), z.y(), c.noise);
    note(c, f);
  }
  keep();
  if (start_due(features)) start_landmarks(features);
  if (calibration_.enabled()) finish_calibration();
  if (resampling_due()) resample();
}

MotionNoise Mapper::motion_noise() const {
  return {p_.distance_noise_per_sqrt_m, p_.turn_noise_per_sqrt_m, p_.lateral_noise_per_sqrt_m,
          p_.odometry_floor_m};
}

void Mapper::move(const MotionIncrement& moved, Features& features) {
  ++frames_used_;
  const Pose2 before = pose_.mean;
  set_motion(moved);
  move_by_mean(particles_, moved_);
  check_poses();
  pose_ = estimate_pose(particles_);
  pose_by_calibration_.row(0) -= (pose_.mean.y_m - before.y_m) * pose_by_calibration_.row(2);
  pose_by_calibration_.row(1) += (pose_.mean.x_m - before.x_m) * pose_by_calibration_.row(2);
  for (Feature& f : features) {
    const Eigen::Vector2d shift = calibration_effect({f.zx, f.zy}, growth_) * calibration_.beta();
    f.zx += static_cast<float>(shift.x());
    f.zy += static_cast<float>(shift.y());
    f.noise = observation_noise(f.zx * f.zx + f.zy * f.zy);
  }
  place_cameras(particles_, lever_m());
}

void Mapper::sense(const Features& features, const FeatureExtractor& view) {
  match(features, view);
  weigh(features);
}

void Mapper::match(const Features& features, const FeatureExtractor& view) {
  predict_candidates(view);
  associate(features, view);
}

void Mapper::weigh(const Features& features) {
  blind_ = !first_ && !sees_map();
  if (blind_) {
    ++counters_.frames_blind;
    return wait_for_landmarks();
  }
  learn_noise(features);
  trust_matches(features);
  carry_drift();
  if (calibration_.enabled()) learn_calibration(features);
  weigh_and_move(features);
}

bool Mapper::sees_map() const {
  const auto seen = std::count_if(candidates_[0].begin(), candidates_[0].end(),
                                  [](const Candidate& c) { return c.promoted && c.inlier; });
  return seen >= kLeastSeen;
}

// Where the particles are is not known well enough for what this frame shows: nothing is made of
// it, and the wheels' error is drawn later.
void Mapper::wait_for_landmarks() {
  loop_closing_ = false;
  correction_ = PoseCorrection{};
  corner_used_.fill(false);
  for (Candidate& c : candidates_[0]) {
    c.corner = -1;
    c.inlier = false;
  }
  carry_drift();
}

void Mapper::estimate() {
  effective_ = normalise_weights(particles_, counters_.repairs);
  pose_ = estimate_pose(particles_);
  const Eigen::Matrix3d R = turned(pose_.mean.theta_rad);
  pose_.covariance += R * undrawn_.covariance * R.transpose();
  if (!calibration_.enabled()) return;
  // All particles share one calibration: what it may still have wrong is not in their spread.
  const PoseSensitivity& A = pose_by_calibration_;
  pose_.covariance += A * calibration_.covariance() * A.transpose();
  check_estimate();
}

// How pose and landmarks depend on the calibration, and what the residuals tell of it.
// Runs before the particles move, at the one that weighs most.
void Mapper::learn_calibration(const Features& features) {
  const int best = heaviest_particle();
  const Eigen::Matrix3d Q = motion_.covariance + 4e-10 * Eigen::Matrix3d::Identity();
  calibration_.begin_frame(Q.llt().solve(Eigen::Matrix3d::Identity()));
  const auto for_each_inlier = [&](auto&& visit) {
    for (const Candidate& c : candidates_[0]) {
      if (!c.inlier) continue;
      const Feature& f = features[static_cast<std::size_t>(c.corner)];
      const Eigen::Vector2d z = seen_at(c, f).cast<double>();
      const ObservationModel model = linearise(map_->rows(c.slot), particles_.camera, best,
                                               lever_m(), static_cast<double>(c.noise));
      visit(c, z, model,
            residual_sensitivity(model, z, map_->by_calibration(c.slot), pose_by_calibration_,
                                 map_->anchor_by_calibration(c.slot), growth_));
    }
  };
  for_each_inlier([&](const Candidate& c, const Eigen::Vector2d& z, const ObservationModel&,
                      const SightSensitivity& D) {
    if (!c.promoted) return;
    calibration_.add(c.anchor, z - c.m, c.G, D, c.own_trusted().inverse(), c.u);
  });
  PoseSensitivity gain = calibration_.pose_gain();
  if (!gain.allFinite()) return restart_calibration();
  gain.topRows<2>() = rotation(pose_.mean.theta_rad) * gain.topRows<2>();
  pose_by_calibration_ += gain;
  for_each_inlier(
      [&](const Candidate& c, const Eigen::Vector2d&, const ObservationModel& model,
          const SightSensitivity& D) { map_->by_calibration(c.slot) += model.gain * D; });
}

int Mapper::heaviest_particle() const {
  const auto weight = particles_.weight.first(static_cast<std::size_t>(particles_.count));
  return static_cast<int>(std::max_element(weight.begin(), weight.end()) - weight.begin());
}

// The calibration was learned a little better: poses move with it now, landmarks when next touched.
void Mapper::move_by_calibration(const CalibrationVector& step) {
  const Eigen::Vector3d move = -pose_by_calibration_ * step;
  for (int i = 0; i < particles_.count; ++i) {
    const Pose2 pose = particles_.pose(i);
    particles_.set_pose(i, {pose.x_m + move.x(), pose.y_m + move.y(), pose.theta_rad + move.z()});
  }
  if (owns_map()) tell_closings(step);
  map_->set_calibration(calibration_.beta());
}

void Mapper::weigh_and_move(const Features& features) {
  if (jumped_) jump_particles();
  if (p_.optimal_proposal != 0) {
    add_proposals(features);
    if (!first_) draw_from_proposal(particles_, motion_.covariance, proposal_, random_);
  } else {
    draw_from_motion(particles_, motion_.covariance, random_);
    check_poses();
    place_cameras(particles_, lever_m());
    add_likelihoods(features);
  }
  undrawn_ = {};
  check_poses();
  if (jumped_) carry_recent_map();
  if (gliding_) glide();
  place_cameras(particles_, lever_m());
}

void Mapper::add_proposals(const Features& features) {
  const auto lever = lever_m().cast<float>().eval();
  proposal_.clear(particles_.count);
  int anchor = -1;
  bool shared = false;
  for (const Candidate& c : candidates_[0]) {
    if (!c.promoted || !c.inlier) continue;
    if (c.anchor != anchor && std::exchange(shared, false)) {
      marginalise_shared(particles_.count, proposal_);
    }
    anchor = c.anchor;
    shared = shared || c.shared != 0.0;
    const Eigen::Vector2f z = seen_at(c, features[static_cast<std::size_t>(c.corner)]);
    add_to_proposal(map_->rows(c.slot), particles_.camera, particles_.count, lever,
                    {z.x(), z.y(), c.noise, static_cast<float>(c.shared)},
                    static_cast<float>(c.rho), proposal_);
  }
  if (shared) marginalise_shared(particles_.count, proposal_);
}

void Mapper::carry_drift() {
  const double noise = noise_scale_.kappa() * static_cast<double>(noise_);
  drift_.begin_frame(pose_.mean * lever_m());
  for (const Candidate& c : candidates_[0]) {
    if (!c.inlier || !c.promoted) continue;
    const LandmarkInfo& l = map_->info(c.slot);
    drift_.add(map_->anchor_drift(l.anchor), 1.0 / std::max(static_cast<double>(l.rho), 0.05),
               noise);
  }
  drift_.end_frame();
}

Eigen::Matrix3d Mapper::pose_covariance() const {
  Eigen::Matrix3d P = pose_.covariance + drift_.covariance();
  P.topLeftCorner<2, 2>() += map_error(map_errors_, pose_.mean.position());
  return P;
}

// A corner's error goes with the direction that it is seen from, and a robot that passes by sees it
// from few: n sights tell of the place as if they were n / (1 + n rho^2 / 4), rho the memory of the
// residuals. The factor was measured: real landmarks err twice what independent errors explain.
Eigen::Matrix3d Mapper::landmark_covariance(const LandmarkInfo& l) const {
  const double memory = noise_scale_.memory();
  const double lasting = 1.0 + 0.25 * memory * memory * l.observations;
  Eigen::Matrix3d P = lasting * l.covariance();
  const Eigen::Vector2d at = l.position_m().head<2>();
  P.topLeftCorner<2, 2>() += carried_drift(map_->anchor_drift(l.anchor), at).topLeftCorner<2, 2>() +
                             map_error(map_errors_, at);
  const double scale_m = map_errors_.scale * (l.position_m().z() - robot_.mount.z_m);
  P(2, 2) += scale_m * scale_m;
  return P;
}

// The paper's proposal. A landmark's likelihood stands alone here: the common error of n landmarks
// is added to each of them n times, so that they tell of it once.
void Mapper::add_likelihoods(const Features& features) {
  const auto counts = [](const Candidate& c) { return c.promoted && c.inlier; };
  for (const Candidate& c : candidates_[0]) {
    if (!counts(c)) continue;
    const auto n = std::count_if(
        candidates_[0].begin(), candidates_[0].end(),
        [&](const Candidate& other) { return counts(other) && other.anchor == c.anchor; });
    const double shared = c.shared * std::sqrt(static_cast<double>(n));
    const Eigen::Vector2f z = seen_at(c, features[static_cast<std::size_t>(c.corner)]);
    add_log_likelihood(map_->rows(c.slot), particles_.camera, particles_.count,
                       {z.x(), z.y(), c.noise, static_cast<float>(shared)},
                       static_cast<float>(p_.likelihood_cap), particles_.log_weight.data());
  }
}

bool Mapper::resampling_due() const {
  return effective_ < p_.resample_below * static_cast<double>(particles_.count);
}

std::span<const std::uint16_t> Mapper::resample() {
  const auto n = static_cast<std::size_t>(particles_.count);
  systematic_resample(particles_.weight.first(n), random_.uniform(), parents_);
  std::fill_n(particles_.log_weight.begin(), n, 0.0);
  std::fill_n(particles_.weight.begin(), n, 1.0 / static_cast<double>(n));
  follow(parents_);
  map_->resampled(parents_);
  ++counters_.resamplings;
  return parents_;
}

void Mapper::follow(std::span<const std::uint16_t> parents) {
  const auto n = static_cast<std::size_t>(particles_.count);
  for (const std::span<double>& row : {particles_.x_m, particles_.y_m, particles_.theta_rad}) {
    for (std::size_t i = 0; i < n; ++i) resample_scratch_[i] = row[parents[i]];
    std::copy_n(resample_scratch_.begin(), n, row.begin());
  }
  place_cameras(particles_, lever_m());
}

void Mapper::freeze_calibration() {
  calibration_.freeze();
}

void Mapper::join(Mapper& host, std::span<const Pose2> T_host_own) {
  assert(particles_.count == host.particles_.count && host.map_ == &host.own_map_);
  for (int i = 0; i < particles_.count; ++i) {
    particles_.set_pose(i, T_host_own[static_cast<std::size_t>(i)] * particles_.pose(i));
  }
  anchor_heading_rad_ -= pose_.mean.theta_rad;
  particles_.weight = host.particles_.weight;
  particles_.log_weight = host.particles_.log_weight;
  map_ = host.map_;
  closing_search_.reset();
  freeze_calibration();
  place_cameras(particles_, lever_m());
  estimate();
  anchor_heading_rad_ += pose_.mean.theta_rad;
}

}  // namespace zenith
