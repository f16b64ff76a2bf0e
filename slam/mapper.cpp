#include "slam/mapper.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "slam/filter/resample.h"

namespace zenith {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kWellInside_px = 24;
constexpr double kSettledRadius_px = 2.5;
constexpr double kNewLandmarkDistance_px = 5.0;
constexpr int kEstablishedObservations = 10;
constexpr int kEnoughToSteer = 15;
// A wheel that slips between two frames: forward, left, turn.
const Eigen::Vector3d kSlip(0.02, 0.01, 2.0 * kDegree);
constexpr double kSlipDistance2 = 20.0;  // chi squared, 3 degrees of freedom: 1 in 6000
constexpr double kTentativeWay_m = 1.0;  // a tentative landmark unseen for this long is forgotten

}  // namespace

void Mapper::layout(Arena& arena, const Parameters& parameters) {
  const int n = std::min(parameters.particles, kMaxParticles);
  particles_.layout(arena, n);
  map_.layout(arena, n);
  associator_.layout(arena);
  proposal_.layout(arena, n);
  const auto stride = static_cast<std::size_t>(row_stride(n));
  prediction_ = {arena.take<float>(stride).data(), arena.take<float>(stride).data(),
                 arena.take<float>(stride).data(), arena.take<float>(stride).data(),
                 arena.take<float>(stride).data()};
  candidates_ = arena.take<Candidates>(1);
  parents_ = arena.take<std::uint16_t>(static_cast<std::size_t>(n));
  resample_scratch_ = arena.take<double>(stride);
}

void Mapper::build(const RobotConfig& robot, const Parameters& parameters, std::uint64_t seed) {
  robot_ = robot;
  p_ = parameters;
  random_ = Random(seed, 1);
  const double f = Pinhole::from_fov(p_.rectified_fov_deg * kDegree).focal_px;
  noise_ = static_cast<float>(p_.pixel_sigma_px * p_.pixel_sigma_px / (f * f));
  association_.gate_sigma = p_.gate_sigma;
  association_.ncc_min = static_cast<float>(p_.ncc_match);
  pixel_ = 1.0 / f;
  association_.min_radius = 1.5 * pixel_;
  map_.reset();
  calibration_.reset(p_.tilt_sigma_deg * kDegree, p_.focal_sigma);
  const auto n = static_cast<std::size_t>(particles_.count);
  std::fill_n(particles_.weight.begin(), n, 1.0 / static_cast<double>(n));
  place_cameras(particles_, lever_m());
  effective_ = static_cast<double>(n);
}

bool Mapper::worth_using(const WheelTravel& travel) const {
  const Pose2 moved = wheel_motion(robot_.wheels, travel);
  return first_ || std::hypot(moved.x_m, moved.y_m) >= p_.min_travel_m ||
         std::abs(moved.theta_rad) >= p_.min_turn_deg * kDegree;
}

void Mapper::update(const WheelTravel& travel, Features& features,
                    const FeatureExtractor& view) {
  const MotionNoise noise = {p_.distance_noise_per_sqrt_m, p_.turn_noise_per_sqrt_m,
                             p_.lateral_noise_per_sqrt_m, p_.odometry_floor_m};
  motion_ = motion_increment(robot_.wheels, travel, noise);
  travelled_m_ += std::hypot(motion_.mean.x_m, motion_.mean.y_m);
  if (p_.optimal_proposal != 0) {
    move_by_mean(particles_, motion_);
  } else {
    move_by_sample(particles_, motion_, random_);
  }
  pose_ = estimate_pose(particles_);
  for (Feature& f : features) {
    const Eigen::Vector2d shift = calibration_effect({f.zx, f.zy}) * calibration_.beta();
    f.zx += static_cast<float>(shift.x());
    f.zy += static_cast<float>(shift.y());
  }
  place_cameras(particles_, lever_m());

  predict_candidates(view);
  associate(features);
  if (calibration_.enabled()) learn_calibration(features);
  weigh_and_move(features);
  effective_ = normalise_weights(particles_);
  pose_ = estimate_pose(particles_);
  update_landmarks(features);
  keep(candidates_[0]);
  start_landmarks(features);
  if (calibration_.enabled()) move_by_calibration(calibration_.end_frame());
  resample_if_needed();
  first_ = false;
}

Eigen::Matrix3d Mapper::spread_in_body() const {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(-pose_.mean.theta_rad);
  return R * pose_.covariance * R.transpose();
}

// Landmarks that may be in the image, by their last known place; then exactly, by their rows.
void Mapper::predict_candidates(const FeatureExtractor& view) {
  Candidates& candidates = candidates_[0];
  candidates.clear();
  const Pose2& pose = pose_.mean;
  const Eigen::Vector2d camera = pose * lever_m();
  const double reach = std::tan(0.5 * p_.rectified_fov_deg * kDegree) * std::numbers::sqrt2 + 0.3;
  const auto landmarks = map_.landmarks();
  for (std::size_t slot = 0; slot < landmarks.size(); ++slot) {
    const LandmarkInfo& l = landmarks[slot];
    if (l.state == LandmarkState::kFree) continue;
    if (l.state == LandmarkState::kTentative && travelled_m_ - l.last_seen_travel_m > kTentativeWay_m) {
      map_.remove(static_cast<int>(slot));
      ++counters_.landmarks_pruned;
      continue;
    }
    const double dx = static_cast<double>(l.x_m) - camera.x();
    const double dy = static_cast<double>(l.y_m) - camera.y();
    const double r = reach / static_cast<double>(std::max(l.rho, 0.1F)) + 0.5;
    if (dx * dx + dy * dy > r * r) continue;
    Candidate c;
    if (!predict_candidate(static_cast<int>(slot), view, c)) continue;
    if (!candidates.push_back(c)) ++counters_.candidates_rejected_full;
  }
  // At the start, and in a place quite new, tentative landmarks must steer: across their parallax
  // they are as good as any.
  const auto known = std::count_if(candidates.begin(), candidates.end(),
                                   [](const Candidate& c) { return c.promoted && !c.old; });
  if (known >= kEnoughToSteer) return;
  for (Candidate& c : candidates) c.promoted = true;
}

bool Mapper::predict_candidate(int slot, const FeatureExtractor& view, Candidate& c) {
  const LandmarkInfo& info = map_.info(slot);
  const LandmarkRows rows = map_.rows(slot);
  predict_landmark(rows, particles_.camera, particles_.count, prediction_);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d own = Eigen::Matrix2d::Zero();
  double rho = 0.0;
  for (int i = 0; i < particles_.count; ++i) {
    const double w = particles_.weight[static_cast<std::size_t>(i)];
    const Eigen::Vector2d m(prediction_.mx[i], prediction_.my[i]);
    mean += w * m;
    spread += w * m * m.transpose();
    own(0, 0) += w * static_cast<double>(prediction_.sxx[i]);
    own(0, 1) += w * static_cast<double>(prediction_.sxy[i]);
    own(1, 1) += w * static_cast<double>(prediction_.syy[i]);
    rho += w * static_cast<double>(rows.rho[i]);
  }
  own(1, 0) = own(0, 1);
  c.slot = slot;
  c.m = mean;
  c.own = own + static_cast<double>(noise_) * Eigen::Matrix2d::Identity();
  c.promoted = info.state == LandmarkState::kPromoted;
  const double unseen_m = travelled_m_ - info.last_seen_travel_m;
  c.old = unseen_m > p_.loop_travel_m;
  const Eigen::Vector2d l = lever_m();
  c.G << -rho, 0.0, mean.y() + rho * l.y(), 0.0, -rho, -(mean.x() + rho * l.x());
  c.common = spread - mean * mean.transpose() + c.G * motion_.covariance * c.G.transpose();
  if (c.old) {
    const double drift = p_.loop_drift * unseen_m * rho;
    c.common += drift * drift * Eigen::Matrix2d::Identity();
  }
  c.well_inside = view.sees(mean, kWellInside_px);
  return view.sees(mean, 8);
}

// Recent promoted landmarks fix the pose; then, with the pose known, everything else is matched:
// changed looks, tentative landmarks, and old landmarks in case a loop closes.
void Mapper::associate(const Features& features) {
  const auto candidates = candidates_[0].span();
  const auto feats = features.span();
  const double heading = pose_.mean.theta_rad;
  corner_used_.fill(false);
  loop_closing_ = false;
  correction_ = PoseCorrection{};
  // Much larger than the model says: the matches decide, also when a wheel slips; the prior only
  // keeps directions that no match fixes.
  Eigen::Matrix3d prior = 4.0 * motion_.covariance;
  prior.diagonal() += kSlip.cwiseAbs2();
  using enum CandidateKind;
  associator_.match(candidates, kPromotedRecent, correction_, 4.0, feats, map_, heading,
                    association_, corner_used_);
  correction_ = agree_on_pose(candidates, kPromotedRecent, feats, prior, Eigen::Vector3d::Zero(),
                              p_.gate_sigma);
  if (correction_.inliers >= 8) {
    corner_used_.fill(false);
    AssociationSettings settled = association_;
    settled.ncc_min = static_cast<float>(p_.ncc_match_settled);
    settled.max_radius = kSettledRadius_px * pixel_;
    associator_.match(candidates, kPromotedRecent, correction_, 0.0, feats, map_, heading, settled,
                      corner_used_);
    correction_ = agree_on_pose(candidates, kPromotedRecent, feats, prior, correction_.xi,
                                p_.gate_sigma);
  }
  if (correction_.inliers >= 8) believe_slip();
  // Corners whose match disagrees are free for others.
  for (const Candidate& c : candidates) {
    if (c.corner >= 0 && !c.inlier) corner_used_[static_cast<std::size_t>(c.corner)] = false;
  }
  loop_closing_ = try_loop(features, prior, correction_);
  associator_.match(candidates, kTentative, correction_, 1.0, feats, map_, heading, association_,
                    corner_used_);
  for (Candidate& c : candidates) {
    if (c.promoted || c.corner < 0) continue;
    const Feature& f = feats[static_cast<std::size_t>(c.corner)];
    const Eigen::Vector2d d = Eigen::Vector2d(f.zx, f.zy) - c.m - c.G * correction_.xi;
    const Eigen::Matrix2d S = c.own + c.G * correction_.covariance * c.G.transpose();
    c.inlier = d.dot(S.inverse() * d) < p_.gate_sigma * p_.gate_sigma;
  }
}

// What the landmarks say of the motion, against what the wheels say: beyond doubt the wheels slipped.
void Mapper::believe_slip() {
  const Eigen::Matrix3d S = motion_.covariance + correction_.covariance;
  const Eigen::Vector3d& xi = correction_.xi;
  if (xi.dot(S.ldlt().solve(xi)) < kSlipDistance2) return;
  motion_.covariance.diagonal() += xi.cwiseAbs2();
  ++counters_.slips;
}

// Old landmarks that agree among themselves on another pose than the recent ones: the drift since
// they were last seen has become visible.
bool Mapper::try_loop(const Features& features, const Eigen::Matrix3d& prior,
                      const PoseCorrection& recent) {
  const auto candidates = candidates_[0].span();
  const auto feats = features.span();
  double unseen_m = 0.0;
  int count = 0;
  for (const Candidate& c : candidates) {
    if (!is_kind(c, CandidateKind::kPromotedOld)) continue;
    unseen_m = std::max(unseen_m, travelled_m_ - map_.info(c.slot).last_seen_travel_m);
    ++count;
  }
  if (count < p_.loop_min_inliers) return false;
  const double position = p_.loop_drift * unseen_m;
  const double heading = p_.loop_drift_deg_per_m * kDegree * unseen_m;
  Eigen::Matrix3d drift = prior + spread_in_body();
  drift.diagonal() += Eigen::Vector3d(position * position, position * position, heading * heading);
  PoseCorrection around = recent;
  associator_.match(candidates, CandidateKind::kPromotedOld, around, 1.0, feats, map_,
                    pose_.mean.theta_rad, association_, corner_used_);
  const PoseCorrection found =
      find_pose(candidates, CandidateKind::kPromotedOld, feats, drift, p_.gate_sigma);
  if (found.inliers < p_.loop_min_inliers) {
    for (Candidate& c : candidates) {
      if (is_kind(c, CandidateKind::kPromotedOld)) c.inlier = false;
    }
    return false;
  }
  const Eigen::Vector3d jump = found.xi - recent.xi;
  const Eigen::Matrix3d C = found.covariance + recent.covariance;
  const double d2 = jump.dot(C.ldlt().solve(jump));
  motion_.covariance += Eigen::Vector3d(jump.x() * jump.x(), jump.y() * jump.y(),
                                        jump.z() * jump.z()).asDiagonal();
  ++counters_.loops_closed;
  correction_ = found;
  if (d2 > 16.0) follow_old_map();
  return true;
}

// The old map is right and what was mapped since the last frames is bent: recent landmarks do not
// steer in this frame, and those that contradict the old map do not count as seen.
void Mapper::follow_old_map() {
  for (Candidate& c : candidates_[0]) {
    if (is_kind(c, CandidateKind::kPromotedRecent) && c.corner >= 0) {
      corner_used_[static_cast<std::size_t>(c.corner)] = false;
      c.corner = -1;
      c.inlier = false;
    }
  }
}

// Propagates how pose and landmarks depend on the calibration, and what the residuals tell of it. Runs
// before the particles move, at the one that weighs most.
void Mapper::learn_calibration(const Features& features) {
  const auto n = static_cast<std::ptrdiff_t>(particles_.count);
  const int best = static_cast<int>(
      std::max_element(particles_.weight.begin(), particles_.weight.begin() + n) -
      particles_.weight.begin());
  const Eigen::Vector2d moved =
      rotation(pose_.mean.theta_rad - motion_.mean.theta_rad) * motion_.mean.position();
  pose_by_calibration_.row(0) -= moved.y() * pose_by_calibration_.row(2);
  pose_by_calibration_.row(1) += moved.x() * pose_by_calibration_.row(2);

  const Eigen::Matrix3d Q = motion_.covariance + 4e-10 * Eigen::Matrix3d::Identity();
  calibration_.begin_frame(Q.llt().solve(Eigen::Matrix3d::Identity()));
  const auto for_each_inlier = [&](auto&& visit) {
    for (const Candidate& c : candidates_[0]) {
      if (!c.inlier) continue;
      const Feature& f = features[static_cast<std::size_t>(c.corner)];
      const Eigen::Vector2d z(f.zx, f.zy);
      const ObservationModel model = linearise(map_.rows(c.slot), particles_.camera, best,
                                               lever_m(), static_cast<double>(noise_));
      visit(c, z, model,
            residual_sensitivity(model, z, map_.by_calibration(c.slot), pose_by_calibration_,
                                 map_.anchor_by_calibration(c.slot)));
    }
  };
  for_each_inlier([&](const Candidate& c, const Eigen::Vector2d& z, const ObservationModel&,
                      const Eigen::Matrix<double, 2, 3>& D) {
    if (!c.promoted) return;
    const Eigen::Matrix2d W = c.own.inverse();
    const Eigen::Vector2d r = z - c.m;
    const Eigen::Vector2d after = r - c.G * correction_.xi;
    calibration_.add(r, c.G, D, W / (1.0 + after.dot(W * after) / 4.0));
  });
  PoseSensitivity gain = calibration_.pose_gain();
  gain.topRows<2>() = rotation(pose_.mean.theta_rad) * gain.topRows<2>();
  pose_by_calibration_ += gain;
  for_each_inlier([&](const Candidate& c, const Eigen::Vector2d&, const ObservationModel& model,
                      const Eigen::Matrix<double, 2, 3>& D) { map_.by_calibration(c.slot) += model.gain * D; });
}

// The calibration was learned a little better: poses move with it now, landmarks when next touched.
void Mapper::move_by_calibration(const Eigen::Vector3d& step) {
  const Eigen::Vector3d move = pose_by_calibration_ * step;
  for (int i = 0; i < particles_.count; ++i) {
    const Pose2 pose = particles_.pose(i);
    particles_.set_pose(i, {pose.x_m + move.x(), pose.y_m + move.y(), pose.theta_rad + move.z()});
  }
  map_.set_calibration(calibration_.beta());
}

void Mapper::weigh_and_move(const Features& features) {
  const bool optimal = p_.optimal_proposal != 0;
  const auto lever = lever_m().cast<float>().eval();
  proposal_.clear(particles_.count);
  for (const Candidate& c : candidates_[0]) {
    if (!c.promoted || !c.inlier) continue;
    const Feature& f = features[static_cast<std::size_t>(c.corner)];
    const LandmarkRows rows = map_.rows(c.slot);
    if (optimal) {
      add_to_proposal(rows, particles_.camera, particles_.count, lever, f.zx, f.zy, noise_,
                      proposal_);
    } else {
      add_log_likelihood(rows, particles_.camera, particles_.count, f.zx, f.zy, noise_,
                         static_cast<float>(p_.likelihood_cap), particles_.log_weight.data());
    }
  }
  if (optimal && !first_) draw_from_proposal(particles_, motion_, proposal_, random_);
  place_cameras(particles_, lever_m());
}

void Mapper::update_landmarks(const Features& features) {
  for (const Candidate& c : candidates_[0]) {
    if (!c.inlier) continue;
    const Feature& f = features[static_cast<std::size_t>(c.corner)];
    update_landmark(map_.rows(c.slot), particles_.camera, particles_.count, f.zx, f.zy, noise_);
    map_.refresh_place(c.slot, particles_.weight.data(), robot_.mount.z_m);
    note_observation(c, f);
  }
}

void Mapper::note_observation(const Candidate& c, const Feature& f) {
  LandmarkInfo& l = map_.info(c.slot);
  ++l.observations;
  l.misses_in_row = 0;
  l.last_seen_travel_m = travelled_m_;
  l.changed = true;
  const auto direction = static_cast<float>(
      wrap_angle(pose_.mean.theta_rad + static_cast<double>(f.orientation_rad)));
  const float best = map_.best_ncc(c.slot, f.patch, direction, 4.0F);
  if (best < static_cast<float>(p_.ncc_new_appearance) &&
      !map_.add_appearance(c.slot, f.patch, f.compact, direction)) {
    ++counters_.appearances_rejected_full;
  }
}

// Promotion and pruning.
void Mapper::keep(const Candidates& candidates) {
  for (const Candidate& c : candidates) {
    LandmarkInfo& l = map_.info(c.slot);
    if (c.well_inside || c.inlier) ++l.chances;
    if (!c.inlier && (c.well_inside || l.state == LandmarkState::kTentative)) ++l.misses_in_row;
    if (l.state == LandmarkState::kTentative) {
      const double z = static_cast<double>(l.z_m);
      const bool known = static_cast<double>(l.rho_sigma) <
                         p_.promote_height_sigma * static_cast<double>(l.rho);
      const bool possible = z >= p_.min_height_m && z <= p_.max_height_m && l.rho > 0.0F;
      if (l.observations >= p_.promote_observations && known && possible) {
        l.state = LandmarkState::kPromoted;
        ++counters_.landmarks_promoted;
      } else if (l.misses_in_row >= 4 || (l.observations >= 40 && known && !possible)) {
        map_.remove(c.slot);
        ++counters_.landmarks_pruned;
      }
    } else if (l.observations < kEstablishedObservations && l.misses_in_row > 30) {
      map_.remove(c.slot);
      ++counters_.landmarks_pruned;
    }
  }
}

bool Mapper::near_candidate(const Feature& f) const {
  const double r = kNewLandmarkDistance_px * pixel_;
  for (const Candidate& c : candidates_[0]) {
    if (map_.info(c.slot).state == LandmarkState::kFree) continue;
    const Eigen::Vector2d d = Eigen::Vector2d(f.zx, f.zy) - c.m - c.G * correction_.xi;
    if (d.squaredNorm() < r * r) return true;
  }
  return false;
}

void Mapper::start_landmarks(const Features& features) {
  const double turned = std::abs(wrap_angle(pose_.mean.theta_rad - anchor_heading_rad_));
  if (!first_ && travelled_m_ - anchor_travel_m_ < p_.anchor_distance_m && turned < 5.0 * kDegree) {
    return;
  }
  const int anchor = map_.create_anchor(particles_.camera, pose_by_calibration_);
  if (anchor < 0) {
    ++counters_.landmarks_rejected_full;
    return;
  }
  anchor_travel_m_ = travelled_m_;
  anchor_heading_rad_ = pose_.mean.theta_rad;
  const double lo = 1.0 / (p_.max_height_m - robot_.mount.z_m);
  const double hi = 1.0 / std::max(p_.min_height_m - robot_.mount.z_m, 0.3);
  const auto rho_mean = static_cast<float>(std::sqrt(lo * hi));
  const auto rho_sigma = static_cast<float>(0.25 * (hi - lo));
  for (std::size_t k = 0; k < features.size(); ++k) {
    const Feature& f = features[k];
    if (corner_used_[k] || !f.described || near_candidate(f)) continue;
    if (map_.size() == kMaxLandmarks) evict_one();
    const int slot = map_.create(anchor);
    if (slot < 0) {
      ++counters_.landmarks_rejected_full;
      continue;
    }
    start_landmark(map_.rows(slot), particles_.count, f.zx, f.zy, noise_, rho_mean, rho_sigma);
    map_.refresh_place(slot, particles_.weight.data(), robot_.mount.z_m);
    LandmarkInfo& l = map_.info(slot);
    l.observations = 1;
    l.chances = 1;
    l.last_seen_travel_m = travelled_m_;
    const double direction = wrap_angle(pose_.mean.theta_rad + static_cast<double>(f.orientation_rad));
    if (!map_.add_appearance(slot, f.patch, f.compact, static_cast<float>(direction))) {
      ++counters_.appearances_rejected_full;
    }
    ++counters_.landmarks_created;
  }
  map_.release_if_unused(anchor);
}

// The least useful landmark gives way: tentative before promoted, then the least observed, then the
// longest unseen. Never one in view.
void Mapper::evict_one() {
  int worst = -1;
  double worst_value = 0.0;
  const auto landmarks = map_.landmarks();
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const LandmarkInfo& l = landmarks[i];
    if (l.state == LandmarkState::kFree || l.last_seen_travel_m > travelled_m_ - 1.0) continue;
    const double value = (l.state == LandmarkState::kPromoted ? 1e6 : 0.0) +
                         100.0 * std::min(l.observations, 50) + l.last_seen_travel_m * 1e-3;
    if (worst < 0 || value < worst_value) {
      worst = static_cast<int>(i);
      worst_value = value;
    }
  }
  if (worst < 0) return;
  map_.remove(worst);
  ++counters_.landmarks_evicted;
}

void Mapper::resample_if_needed() {
  const auto n = static_cast<std::size_t>(particles_.count);
  if (effective_ >= p_.resample_below * static_cast<double>(n)) return;
  systematic_resample(particles_.weight.first(n), random_.uniform(), parents_);
  for (const std::span<double>& row : {particles_.x_m, particles_.y_m, particles_.theta_rad}) {
    for (std::size_t i = 0; i < n; ++i) resample_scratch_[i] = row[parents_[i]];
    std::copy_n(resample_scratch_.begin(), n, row.begin());
  }
  std::fill_n(particles_.log_weight.begin(), n, 0.0);
  std::fill_n(particles_.weight.begin(), n, 1.0 / static_cast<double>(n));
  place_cameras(particles_, lever_m());
  map_.resampled(parents_);
  ++counters_.resamplings;
}

}  // namespace zenith
