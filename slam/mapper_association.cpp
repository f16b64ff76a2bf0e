// From the odometry's pose to matched corners: which landmarks can be in view, which corner is
// which landmark, whether a wheel slipped or a loop closes.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "slam/image/patch_shift.h"
#include "slam/mapper.h"

namespace zenith {
namespace {

constexpr int kWellInside_px = 24;
constexpr double kSettledRadius_px = 2.5;
constexpr int kEnoughToSteer = 15;
// Medians of chi squared with one and with two degrees of freedom.
constexpr double kMedianOfOne = 0.4549364;
constexpr double kMedianOfTwo = 1.3862944;
constexpr float kLeastToLocate = 0.7F;  // NCC: below, two patches are too different to align
// A wheel that slips between two frames: forward, left, turn.
const Eigen::Vector3d kSlip(0.02, 0.01, 2.0 * std::numbers::pi / 180.0);
constexpr double kStraight = 0.3;        // rad/m
constexpr double kSlipDistance2 = 20.0;  // chi squared, 3 degrees of freedom: 1 in 6000
constexpr double kScaleKnown = 0.008;    // five times as well as ScaleWatch asks for
constexpr double kDegrees = 4.0;         // of freedom, of a match's error as Student's t

// Of a match from its prediction at the corrected pose, in squared sigmas.
double squared_distance(const Candidate& c, const Feature& f, const PoseCorrection& correction) {
  const Eigen::Vector2d d = seen_at(c, f).cast<double>() - c.m - c.G * correction.xi;
  const Eigen::Matrix2d S = c.own + c.G * correction.covariance * c.G.transpose();
  return d.dot(S.inverse() * d);
}

}  // namespace

Eigen::Matrix3d Mapper::spread_in_body() const {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(-pose_.mean.theta_rad);
  return R * pose_.covariance * R.transpose();
}

// Landmarks that may be in the image, by their last known place; then exactly, by their rows.
void Mapper::predict_candidates(const FeatureExtractor& view) {
  Candidates& candidates = candidates_[0];
  candidates.clear();
  heaviest_ = heaviest_particle();
  const Pose2& pose = pose_.mean;
  const Eigen::Vector2d camera = pose * lever_m();
  const double reach = std::tan(0.5 * p_.rectified_fov_deg * kDegree) * std::numbers::sqrt2 + 0.3;
  const auto landmarks = map_->landmarks();
  for (std::size_t slot = 0; slot < landmarks.size(); ++slot) {
    const LandmarkInfo& l = landmarks[slot];
    if (l.state == LandmarkState::kFree) continue;
    const double dx = static_cast<double>(l.x_m) - camera.x();
    const double dy = static_cast<double>(l.y_m) - camera.y();
    const double r =
        reach / static_cast<double>(std::max(l.rho, static_cast<float>(kLeastRho))) + 0.5;
    if (dx * dx + dy * dy > r * r) continue;
    Candidate c;
    if (!predict_candidate(static_cast<int>(slot), view, c)) continue;
    if (!candidates.push_back(c)) ++counters_.candidates_rejected_full;
  }
  // Those of one anchor side by side.
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.anchor != b.anchor ? a.anchor < b.anchor : a.slot < b.slot;
  });
  relate_to_pose();
  // At the start, and in a place quite new, tentative landmarks must steer: across their parallax
  // they are as good as any.
  const auto known = std::count_if(candidates.begin(), candidates.end(),
                                   [](const Candidate& c) { return c.promoted && !c.old; });
  if (known >= kEnoughToSteer) return;
  for (Candidate& c : candidates) c.promoted = true;
}

void Mapper::relate_to_pose() {
  const DepthSpread depths([this](auto&& visit) {
    for (const Candidate& c : candidates_[0]) visit(c.rho, c.rho_variance);
  });
  const Eigen::Vector2d l = lever_m();
  for (Candidate& c : candidates_[0]) {
    c.rho = depths.expected(c.rho, c.rho_variance);
    c.G << -c.rho, 0.0, c.m.y() + c.rho * l.y(), 0.0, -c.rho, -(c.m.x() + c.rho * l.x());
    c.common += c.G * motion_.covariance * c.G.transpose();
  }
}

bool Mapper::predict_candidate(int slot, const FeatureExtractor& view, Candidate& c) {
  const LandmarkInfo& info = map_->info(slot);
  const LandmarkRows rows = map_->rows(slot);
  const LandmarkPrediction prediction =
      predict_landmark(rows, particles_.camera, particles_.weight.data(), particles_.count);
  const Eigen::Vector2d& mean = prediction.mean;
  const double rho = prediction.rho;
  c.slot = slot;
  c.m = mean;
  const float noise = observation_noise(static_cast<float>(mean.squaredNorm()));
  c.stated_noise = noise;
  c.anchor = info.anchor;
  c.own = prediction.own + static_cast<double>(noise) * Eigen::Matrix2d::Identity();
  // A distance is measured by its inverse.
  const double sums = mean.sum() + prediction.spread.sum() + rho;
  if (!std::isfinite(sums) || !(c.own(0, 0) > 0.0 && c.own.determinant() > 0.0)) {
    drop_landmark(slot);
    return false;
  }
  c.promoted = info.state == LandmarkState::kPromoted;
  const double unseen_m = map_->way_m() - info.last_seen_way_m;
  c.old = unseen_m > p_.loop_travel_m;
  c.rho = rho;
  c.common = prediction.spread;
  if (c.old) {
    const double drift = p_.loop_drift * unseen_m * rho;
    c.common += drift * drift * Eigen::Matrix2d::Identity();
  }
  note_shared(rows, c);
  c.well_inside = view.sees(mean, kWellInside_px);
  return view.sees(mean, 8);
}

// Of the particle that weighs most, for all of them.
void Mapper::note_shared(const LandmarkRows& rows, Candidate& c) const {
  const int i = heaviest_;
  c.rho_variance = static_cast<double>(rows.prr[i]);
  if (depth_prior_.is_settled(static_cast<double>(rows.rho[i]), static_cast<double>(rows.prr[i]))) {
    return;
  }
  c.shared = depth_prior_.shared;
  c.u = c.shared * depth_covariance(rows, particles_.camera, i);
}

// Recent promoted landmarks fix the pose; then, with the pose known, everything else is matched:
// changed looks, tentative landmarks, and old landmarks in case a loop closes.
void Mapper::associate(const Features& features, const FeatureExtractor& view) {
  const auto candidates = candidates_[0].span();
  const auto feats = features.span();
  const double heading = pose_.mean.theta_rad;
  corner_used_.fill(false);
  loop_closing_ = false;
  jumped_ = false;
  gliding_ = false;
  correction_ = PoseCorrection{};
  // Much larger than the model says: the matches decide, also when a wheel slips; the prior only
  // keeps directions that no match fixes.
  Eigen::Matrix3d prior = 4.0 * motion_.covariance;
  prior.diagonal() += kSlip.cwiseAbs2();
  using enum CandidateKind;
  associator_.match(candidates, kPromotedRecent, correction_, 4.0, feats, *map_, heading,
                    association_, corner_used_);
  correction_ = agree_on_pose(candidates, kPromotedRecent, feats, prior, Eigen::Vector3d::Zero(),
                              p_.gate_sigma);
  check_correction();
  if (correction_.inliers >= 8) {
    corner_used_.fill(false);
    AssociationSettings settled = association_;
    settled.ncc_min = static_cast<float>(p_.ncc_match_settled);
    settled.max_radius = kSettledRadius_px * pixel_ * noise_scale_.sigma_factor();
    associator_.match(candidates, kPromotedRecent, correction_, 0.0, feats, *map_, heading, settled,
                      corner_used_);
    locate_matches(kPromotedRecent, features);
    correction_ =
        agree_on_pose(candidates, kPromotedRecent, feats, prior, correction_.xi, p_.gate_sigma);
    check_correction();
  }
  if (correction_.inliers >= 8) {
    const double wheels_m = motion_.mean.x_m;
    const bool straight = std::abs(motion_.mean.theta_rad) < kStraight * std::abs(wheels_m);
    scale_wrong_ =
        straight && knows_scale() && scale_.note(wheels_m, wheels_m + correction_.xi.x());
    believe_slip();
  } else {
    scale_.reset();
  }
  // Corners whose match disagrees are free for others.
  for (const Candidate& c : candidates) {
    if (c.corner >= 0 && !c.inlier) corner_used_[static_cast<std::size_t>(c.corner)] = false;
  }
  // What old landmarks say is said against the recent ones: without those it is another question.
  if (!Tracking::is_weak(match_share())) loop_closing_ = close_loop(features, view, prior);
  // Tentative landmarks go with the robot, and are matched again in the next frame.
  if (!jumped_) match_tentative(features);
  note_drift();
}

void Mapper::match_tentative(const Features& features) {
  const auto candidates = candidates_[0].span();
  const auto feats = features.span();
  associator_.match(candidates, CandidateKind::kTentative, correction_, 1.0, feats, *map_,
                    pose_.mean.theta_rad, association_, corner_used_);
  locate_matches(CandidateKind::kTentative, features);
  for (Candidate& c : candidates) {
    if (c.promoted || c.corner < 0) continue;
    const Feature& f = feats[static_cast<std::size_t>(c.corner)];
    c.inlier = squared_distance(c, f, correction_) < p_.gate_sigma * p_.gate_sigma;
  }
}

// A detector's peak slides along edges and where two depths meet; what a landmark looks like lies
// where it lay. The pose is measured by that.
void Mapper::locate_matches(CandidateKind kind, const Features& features) {
  for (Candidate& c : candidates_[0]) {
    if (!is_kind(c, kind) || c.corner < 0) continue;
    const Feature& f = features[static_cast<std::size_t>(c.corner)];
    const auto orientation = static_cast<double>(f.orientation_rad);
    const auto direction = static_cast<float>(wrap_angle(pose_.mean.theta_rad + orientation));
    const Map::Look look = map_->best_look(c.slot, f.patch, direction, association_.max_turn_rad);
    if (look.appearance == nullptr || look.ncc < kLeastToLocate) continue;
    const auto shift = patch_shift(look.appearance->patch, f.patch);
    if (!shift) continue;
    c.shift_px = *shift + look.appearance->centre_px();
    c.shift = static_cast<float>(pixel_) * (rotation(orientation).cast<float>() * c.shift_px);
  }
}

// How much each match counts. A corner that slides with the view, or lies on two things at once,
// misfits again and again: its noise grows by the landmark's mean misfit. A single match misfits by
// accident: its noise is Student's t, whose expected precision, given the residual in two
// dimensions, is (nu + 2) / (nu + d^2). Neither makes a match better than stated.
void Mapper::trust_matches(const Features& features) {
  for (Candidate& c : candidates_[0]) {
    if (!c.inlier) continue;
    const Feature& f = features[static_cast<std::size_t>(c.corner)];
    const double d2 = squared_distance(c, f, correction_);
    c.misfit = 0.5 * d2;
    const double lasting = std::max(1.0, static_cast<double>(map_->info(c.slot).misfit));
    const double once = std::max(1.0, (kDegrees + d2 / lasting) / (kDegrees + 2.0));
    c.noise = f.noise * static_cast<float>(lasting * once);
  }
}

// Of matches from which the pose has come, agreeing or not.
void Mapper::learn_noise(const Features& features) {
  const double kappa = noise_scale_.kappa();
  const double kappa_1 = noise_scale_.kappa_1();
  for (const Candidate& c : candidates_[0]) {
    if (!is_kind(c, CandidateKind::kPromotedRecent) || c.corner < 0) continue;
    LandmarkInfo& l = map_->info(c.slot);
    const Feature& f = features[static_cast<std::size_t>(c.corner)];
    const double stated = static_cast<double>(c.stated_noise);
    const Eigen::Vector2d e = seen_at(c, f).cast<double>() - c.m - c.G * correction_.xi;
    const Eigen::Matrix2d S = c.own + c.G * correction_.covariance * c.G.transpose() -
                              stated * (1.0 - kappa_1 / kappa) * Eigen::Matrix2d::Identity();
    if (c.shared != 0.0 && c.u.squaredNorm() > 0.0) {
      // Along the parallax its innovation is that of a prior; across it, one of one dimension.
      const Eigen::Vector2d across = Eigen::Vector2d(-c.u.y(), c.u.x()).normalized();
      const double off = across.dot(e);
      noise_scale_.add(kMedianOfTwo / kMedianOfOne * off * off / across.dot(S * across));
      continue;
    }
    noise_scale_.add(e.dot(S.inverse() * e));
    if (l.last_residual_frame == frames_used_ - 1) {
      noise_scale_.add_pair(e.x(), static_cast<double>(l.last_residual[0]));
      noise_scale_.add_pair(e.y(), static_cast<double>(l.last_residual[1]));
    }
    l.last_residual[0] = static_cast<float>(e.x());
    l.last_residual[1] = static_cast<float>(e.y());
    l.last_residual_frame = frames_used_;
  }
  if (noise_scale_.end_frame()) map_->set_noise(static_cast<float>(noise_scale_.kappa()));
}

// Whether the depths of this frame's landmarks are known well enough, and from parallax alone, to
// contradict the wheels' distance: each tells it to sqrt(P) / rho.
bool Mapper::knows_scale() const {
  double information = 0.0;
  for (const Candidate& c : candidates_[0]) {
    if (!is_kind(c, CandidateKind::kPromotedRecent) || !c.inlier || c.shared != 0.0) continue;
    information += c.rho * c.rho / c.rho_variance;
  }
  return information * kScaleKnown * kScaleKnown > 1.0;
}

// What the landmarks say of the motion, against what the wheels say: beyond doubt the wheels
// slipped. Until it is known how noisy corners are they may be as noisy as any.
void Mapper::believe_slip() {
  constexpr double kMost = NoiseScale::kMostNoise * NoiseScale::kMostNoise;
  const double doubt = noise_scale_.settled() ? 1.0 : kMost / noise_scale_.kappa();
  const Eigen::Matrix3d S = motion_.covariance + doubt * correction_.covariance;
  const Eigen::Vector3d& xi = correction_.xi;
  if (xi.dot(S.ldlt().solve(xi)) < kSlipDistance2) return;
  if (!Tracking::is_fair_part(match_share())) return;
  motion_.covariance.diagonal() += xi.cwiseAbs2();
  ++counters_.slips;
}

}  // namespace zenith
