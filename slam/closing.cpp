#include "slam/closing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "slam/recovery/evidence.h"

namespace zenith {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSearch_m = 0.1;
constexpr double kSearch_rad = 4.0 * kDegree;
constexpr double kForget_m = 2.0;  // without old landmarks in view: evidence is of another place
constexpr double kTest_px = 5.0;
constexpr double kHit_px = 2.5;
constexpr int kWellInside_px = 24;
constexpr int kInView_px = 8;
constexpr double kSameTurn_rad = 2.0 * kDegree;

// The correction of a hypothesis in one frame.
const Eigen::Vector3d kLoose(0.1, 0.1, 3.0 * kDegree);

// What a fit's covariance does not tell: corners' errors in common, as a factor of variance.
constexpr double kUnstated = 4.0;
// How far the old map bends between two searches.
const Eigen::Vector3d kBend(0.005, 0.005, 0.05 * kDegree);
constexpr double kTurnSigmas = 4.0;  // of the drift, and a margin: turns that are searched
constexpr double kTurnMargin_rad = 1.0 * kDegree;
// The jump must be known to so much before it is made.
constexpr double kKnown_m = 0.02;
constexpr double kKnown_rad = 0.25 * kDegree;

constexpr HitRates kRates = {0.5, 0.12};
constexpr EvidenceStandard kStandard = {0.5, 12.0, 0.5, 4};

Pose2 pose_of(const Eigen::Vector3d& xi) {
  return {xi.x(), xi.y(), xi.z()};
}

Eigen::Vector3d vector_of(const Pose2& p) {
  return {p.x_m, p.y_m, p.theta_rad};
}

// The candidate as a robot at `moved` (in the body) predicts it.
Candidate moved_candidate(const Candidate& c, const Pose2& moved) {
  Candidate out = c;
  const double rho = -c.G(0, 0);
  const Eigen::Vector2d l = lever_of(c);
  const Eigen::Vector2d camera = moved * l - l;
  out.m = rotation(-moved.theta_rad) * (c.m - rho * camera);
  out.G << -rho, 0.0, out.m.y() + rho * l.y(), 0.0, -rho, -(out.m.x() + rho * l.x());
  out.corner = -1;
  out.inlier = false;
  return out;
}

}  // namespace

double median_drift(std::span<const Candidate> candidates, const Map& map) {
  std::array<float, kMaxCandidates> drift_m;
  std::ptrdiff_t count = 0;
  for (const Candidate& c : candidates) {
    if (!c.inlier || !c.promoted) continue;
    drift_m[static_cast<std::size_t>(count++)] = map.drift_travel_m(c.slot);
  }
  if (count == 0) return 0.0;
  auto* middle = drift_m.begin() + count / 2;
  std::nth_element(drift_m.begin(), middle, drift_m.begin() + count);
  return static_cast<double>(*middle);
}

void ClosingSearch::layout(Arena& arena) {
  tested_ = arena.take<Candidates>(1);
  votes_.layout(arena);
}

void ClosingSearch::build(const Parameters& parameters) {
  pixel_ = 1.0 / Pinhole::from_fov(parameters.rectified_fov_deg * kDegree).focal_px;
  gate_sigma_ = parameters.gate_sigma;
  ncc_min_ = static_cast<float>(parameters.ncc_match);
  min_inliers_ = parameters.loop_min_inliers;
  votes_.build(pixel_, ncc_min_);
  reset();
}

void ClosingSearch::reset() {
  hypotheses_ = {};
  accepted_ = false;
}

// Whether there are enough old landmarks in view to say anything.
bool ClosingSearch::meets_old_map(const ClosingFrame& frame) {
  int old = 0;
  double rho = 0.0;
  for (const Candidate& c : frame.candidates) {
    if (!is_kind(c, CandidateKind::kPromotedOld)) continue;
    ++old;
    rho -= c.G(0, 0);
  }
  if (frame.travelled_m - met_at_m_ > kForget_m) reset();
  if (old < min_inliers_) return false;
  met_at_m_ = frame.travelled_m;
  rho_ = rho / old;
  return true;
}

bool ClosingSearch::update(const ClosingFrame& frame, Associator& associator, Closing& out) {
  tested_[0].clear();
  if (!meets_old_map(frame)) return false;
  const Pose2 recent = frame.T_start_recent();
  const bool due = frame.travelled_m - searched_at_m_ >= kSearch_m ||
                   std::abs(wrap_angle(recent.theta_rad - searched_heading_rad_)) >= kSearch_rad;
  if (due) {
    searched_at_m_ = frame.travelled_m;
    searched_heading_rad_ = recent.theta_rad;
    search(frame, associator);
  }
  const int leader = best();
  if (leader < 0) return false;
  const Hypothesis& h = hypotheses_[static_cast<std::size_t>(leader)];
  if (due) accepted_ = convincing(leader, frame);
  if (!accepted_) return false;
  const Test t = test(frame, h.T_old_recent, associator);
  if (!t.fixed || log_odds(t.support, kRates) <= 0.0) return false;
  out.in_frame = t.correction;
  out.correction.xi = vector_of(frame.T_start_odometry.inverse() * (h.T_old_recent * recent));
  out.correction.covariance = h.covariance;
  out.correction.inliers = t.correction.inliers;
  out.T_old_recent = h.T_old_recent;
  out.drift_travel_m = median_drift(tested_[0].span(), frame.map);
  return true;
}

ClosingSearch::Test ClosingSearch::test(const ClosingFrame& frame, const Pose2& T_old_recent,
                                        Associator& associator) {
  const Pose2 recent = frame.T_start_recent();
  const Pose2 moved = frame.T_start_odometry.inverse() * (T_old_recent * recent);
  Candidates& tested = tested_[0];
  tested.clear();
  for (const Candidate& c : frame.candidates) {
    if (!is_kind(c, CandidateKind::kPromotedOld)) continue;
    Candidate at = moved_candidate(c, moved);
    if (!frame.view.sees(at.m, kInView_px)) continue;
    at.well_inside = frame.view.sees(at.m, kWellInside_px);
    tested.push_back(at);
  }
  AssociationSettings settings;
  settings.gate_sigma = gate_sigma_;
  settings.ncc_min = ncc_min_;
  settings.max_radius = settings.min_radius = kTest_px * pixel_;
  corner_used_.fill(false);
  associator.match(tested.span(), CandidateKind::kPromotedOld, {}, 0.0, frame.features, frame.map,
                   frame.T_start_odometry.theta_rad + moved.theta_rad, settings, corner_used_);
  const Eigen::Matrix3d loose = kLoose.cwiseAbs2().asDiagonal();
  const PoseCorrection step =
      agree_on_pose(tested.span(), CandidateKind::kPromotedOld, frame.features, loose,
                    Eigen::Vector3d::Zero(), gate_sigma_);
  Test out;
  if (step.broken) return out;
  const Pose2 corrected = moved * pose_of(step.xi);
  out.correction = step;
  out.correction.xi = vector_of(corrected);
  out.T_old_recent = frame.T_start_odometry * corrected * recent.inverse();
  for (Candidate& c : tested) c.m += c.G * step.xi;
  out.support = count_support(frame);
  out.fixed = step.inliers >= min_inliers_;
  return out;
}

// A corner serves one landmark: a second one that lies on it is a duplicate, neither there nor
// missing.
Support ClosingSearch::count_support(const ClosingFrame& frame) const {
  const double hit2 = kHit_px * kHit_px * pixel_ * pixel_;
  const auto is_hit = [&](const Candidate& c) {
    if (c.corner < 0) return false;
    const Feature& f = frame.features[static_cast<std::size_t>(c.corner)];
    return c.inlier || (Eigen::Vector2d(f.zx, f.zy) - c.m).squaredNorm() < hit2;
  };
  Support support;
  for (const Candidate& c : tested_[0]) {
    if (!c.well_inside || !is_reliable(frame.map.info(c.slot))) continue;
    const bool hit = is_hit(c);
    const bool duplicate =
        !hit && std::any_of(tested_[0].begin(), tested_[0].end(), [&](const Candidate& other) {
          return is_hit(other) && (other.m - c.m).squaredNorm() < hit2;
        });
    if (duplicate) continue;
    ++support.expected;
    support.hits += hit ? 1 : 0;
  }
  return support;
}

void ClosingSearch::record(const ClosingFrame& frame, Hypothesis& h, const Test& t) {
  const Pose2 recent = frame.T_start_recent();
  h.evidence.add(t.support);
  const Pose2 place = t.T_old_recent * recent;
  h.confidence.add(recent.position(), place.position(), t.fixed);
  fuse(frame, h, t);
  const Eigen::Vector3d jump = vector_of(recent.inverse() * (h.T_old_recent * recent));
  h.jump2 = jump.dot(frame.drift.ldlt().solve(jump));
}

// The transform over the searches: each tells the jump, in the body, and the map bends slowly.
void ClosingSearch::fuse(const ClosingFrame& frame, Hypothesis& h, const Test& t) {
  const Pose2 recent = frame.T_start_recent();
  const auto jump_of = [&](const Pose2& T) { return vector_of(recent.inverse() * (T * recent)); };
  h.covariance += Eigen::Matrix3d(kBend.cwiseAbs2().asDiagonal());
  if (!t.fixed) return;
  const Eigen::Matrix3d C = kUnstated * t.correction.covariance;
  const Eigen::Vector3d before = jump_of(h.T_old_recent);
  const Eigen::Matrix3d K = h.covariance * (h.covariance + C).inverse();
  const Eigen::Vector3d after = before + K * (jump_of(t.T_old_recent) - before);
  h.covariance -= K * h.covariance;
  h.covariance = 0.5 * (h.covariance + h.covariance.transpose()).eval();
  h.T_old_recent = recent * pose_of(after) * recent.inverse();
}

double ClosingSearch::score(const Hypothesis& h) const {
  return h.evidence.score(kRates) - 0.5 * h.jump2;
}

bool ClosingSearch::same(const Pose2& a, const Pose2& b, const ClosingFrame& frame) const {
  const Eigen::Vector2d at = frame.T_start_odometry.position();
  const double apart = (a * at - b * at).norm() * rho_;
  return apart < kTest_px * pixel_ &&
         std::abs(wrap_angle(a.theta_rad - b.theta_rad)) < kSameTurn_rad;
}

int ClosingSearch::best() const {
  int best = -1;
  for (int i = 0; i < kHypotheses; ++i) {
    const Hypothesis& h = hypotheses_[static_cast<std::size_t>(i)];
    if (!h.used) continue;
    if (best < 0 || score(h) > score(hypotheses_[static_cast<std::size_t>(best)])) best = i;
  }
  return best;
}

bool ClosingSearch::convincing(int leader, const ClosingFrame& frame) const {
  const Hypothesis& h = hypotheses_[static_cast<std::size_t>(leader)];
  double runner_up = 0.0;
  for (int i = 0; i < kHypotheses; ++i) {
    const Hypothesis& other = hypotheses_[static_cast<std::size_t>(i)];
    if (i == leader || !other.used) continue;
    if (same(other.T_old_recent, h.T_old_recent, frame)) continue;
    runner_up = std::max(runner_up, score(other));
  }
  const Eigen::Vector3d variance = h.covariance.diagonal();
  const bool known = std::max(variance.x(), variance.y()) < kKnown_m * kKnown_m &&
                     variance.z() < kKnown_rad * kKnown_rad;
  return known &&
         convinces(score(h), h.evidence.searches(), h.confidence.value(), runner_up, kStandard);
}

void ClosingSearch::search(const ClosingFrame& frame, Associator& associator) {
  for (Hypothesis& h : hypotheses_) {
    if (!h.used) continue;
    record(frame, h, test(frame, h.T_old_recent, associator));
    const bool hopeless =
        h.evidence.searches() >= Evidence::kWindow && h.evidence.score(kRates) < -kStandard.score;
    if (hopeless) h = {};
  }
  join_same(frame);
  ensure_identity(frame);
  propose(frame, associator);
}

// Hypotheses that have become the same are one: the better supported.
void ClosingSearch::join_same(const ClosingFrame& frame) {
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    for (std::size_t k = i + 1; k < hypotheses_.size(); ++k) {
      Hypothesis& a = hypotheses_[i];
      Hypothesis& b = hypotheses_[k];
      if (!a.used || !b.used || !same(a.T_old_recent, b.T_old_recent, frame)) continue;
      if (score(b) > score(a)) a = b;
      b = {};
    }
  }
}

void ClosingSearch::propose(const ClosingFrame& frame, Associator& associator) {
  const Pose2 recent = frame.T_start_recent();
  votes_.begin(rho_, kTurnSigmas * std::sqrt(frame.drift(2, 2)) + kTurnMargin_rad);
  for (const Candidate& c : frame.candidates) {
    if (!is_kind(c, CandidateKind::kPromotedOld)) continue;
    votes_.add(moved_candidate(c, pose_of(frame.recent.xi)), frame.map, frame.features,
               recent.theta_rad);
  }
  Pose2 jump;
  for (int i = 0; i < kPeaks && votes_.take_peak(jump); ++i) {
    add(frame, recent * jump * recent.inverse(), associator);
  }
}

// That the pose holds as it is must be tested too.
void ClosingSearch::ensure_identity(const ClosingFrame& frame) {
  for (const Hypothesis& h : hypotheses_) {
    if (h.used && same(h.T_old_recent, {}, frame)) return;
  }
  Hypothesis& h = place_for_one();
  h = {};
  h.used = true;
  h.covariance = kLoose.cwiseAbs2().asDiagonal();
}

// A free one, or the one that is worth least.
ClosingSearch::Hypothesis& ClosingSearch::place_for_one() {
  Hypothesis* least = hypotheses_.data();
  for (Hypothesis& h : hypotheses_) {
    if (!h.used) return h;
    if (score(h) < score(*least)) least = &h;
  }
  return *least;
}

void ClosingSearch::add(const ClosingFrame& frame, const Pose2& T_old_recent,
                        Associator& associator) {
  const Test t = test(frame, T_old_recent, associator);
  if (!t.fixed) return;
  for (const Hypothesis& h : hypotheses_) {
    if (h.used && same(h.T_old_recent, t.T_old_recent, frame)) return;
  }
  Hypothesis fresh;
  fresh.used = true;
  fresh.T_old_recent = t.T_old_recent;
  fresh.covariance = kLoose.cwiseAbs2().asDiagonal();
  record(frame, fresh, t);
  Hypothesis& place = place_for_one();
  if (!place.used || score(place) < score(fresh)) place = fresh;
}

void ClosingSearch::moved(const Pose2& old_by, const Pose2& pose_by) {
  const Pose2 back = pose_by.inverse();
  for (Hypothesis& h : hypotheses_) {
    if (h.used) h.T_old_recent = old_by * h.T_old_recent * back;
  }
}

}  // namespace zenith
