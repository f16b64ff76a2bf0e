#include "slam/joint.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <Eigen/Cholesky>

#include "platform/base/ensure.h"

namespace zenith {
namespace {

constexpr double kSameHeight_m = 0.002;
constexpr std::size_t kLeastPairs = 3;
// What a landmark's place in a map may be off besides its covariance, as in the fleet's alignment.
constexpr double kMapError_m = 0.02;

// The place of a landmark for one particle.
Eigen::Vector2d place(const LandmarkRows& l, std::size_t i) {
  const double h = 1.0 / static_cast<double>(std::max(l.rho[i], static_cast<float>(kLeastRho)));
  const double c = l.anchor_cos[i];
  const double s = l.anchor_sin[i];
  return {l.anchor_x[i] + h * (c * l.ax[i] - s * l.ay[i]),
          l.anchor_y[i] + h * (s * l.ax[i] + c * l.ay[i])};
}

Eigen::Vector3d draw(const Eigen::Matrix3d& covariance, Random& random) {
  const Eigen::Matrix3d L = covariance.llt().matrixL();
  Eigen::Vector3d n;
  for (int k = 0; k < 3; ++k) n[k] = random.normal();
  return L * n;
}

const Feature& matched(const JointFrame& frame, const Candidate& c) {
  return (*frame.features)[static_cast<std::size_t>(c.corner)];
}

}  // namespace

void JointFilter::layout(Arena& arena, const Parameters& parameters) {
  const int n = std::min(parameters.particles, kMaxParticles);
  import_.layout(arena, n);
  transforms_ = arena.take<Pose2>(static_cast<std::size_t>(n));
  points_ = arena.take<PointPair>(kMaxCorrespondences);
  sightings_ = arena.take<Sighting>(std::size_t{kMaxObservers} * kMaxCorners);
}

void JointFilter::build(const Parameters& parameters) {
  import_settings_.ncc_new_appearance = static_cast<float>(parameters.ncc_new_appearance);
  weigh_common_ = parameters.optimal_proposal != 0;
}

void JointFilter::add(Mapper& mapper) {
  ensure(count_ < kMaxObservers, "JointFilter: more robots than kMaxObservers");
  members_[static_cast<std::size_t>(count_)] = {&mapper, count_, {}};
  ++count_;
}

int JointFilter::size_of_group(int leader) const {
  int size = 0;
  for (int i = 0; i < count_; ++i) size += this->leader(i) == leader ? 1 : 0;
  return size;
}

bool JointFilter::join(int host_robot, int guest_robot, const Pose2& T,
                       std::span<const SlotPair> known) {
  assert(host_robot != guest_robot);
  assert(leader(host_robot) == host_robot && leader(guest_robot) == guest_robot);
  Mapper& host = mapper(host_robot);
  Mapper& guest = mapper(guest_robot);
  const auto pairs = import_.find_pairs(host.map(), guest.map(), T, known, import_settings_);
  const double higher_m = guest.robot().mount.z_m - host.robot().mount.z_m;
  if (std::abs(higher_m) > kSameHeight_m || pairs.size() < kLeastPairs) {
    ++counters_.joins_refused;
    return false;
  }
  equalise(host_robot);
  equalise(guest_robot);
  draw_transforms(host, guest, T, pairs);
  const auto weight = host.particles().weight.first(transforms_.size());
  const ImportCounters imported = import_.run(host.map(), guest.map(), transforms_, T, pairs,
                                              weight, host.robot().mount.z_m, import_settings_);
  for (Member& m : members()) {
    if (m.leader != guest_robot) continue;
    m.mapper->join(host, transforms_);
    m.leader = host_robot;
    m.T_leader_start = T * m.T_leader_start;
  }
  const double share = 1.0 / size_of_group(host_robot);
  for (Member& m : members()) {
    if (m.leader != host_robot) continue;
    m.mapper->freeze_calibration();
    m.mapper->set_way_share(share);
    m.mapper->estimate();
  }
  ++counters_.joins;
  counters_.common_landmarks += imported.fused;
  counters_.imported_landmarks += imported.imported;
  counters_.rejected_full += imported.rejected_full;
  return true;
}

void JointFilter::equalise(int leader) {
  const auto parents = mapper(leader).resample();
  for (int robot = 0; robot < count_; ++robot) {
    if (robot != leader && this->leader(robot) == leader) mapper(robot).follow(parents);
  }
}

// Each pair of particles has its own two maps, bent in their own ways: the transform is fitted to
// them and drawn from the fit's Gaussian.
void JointFilter::draw_transforms(Mapper& host, Mapper& guest, const Pose2& T,
                                  std::span<const SlotPair> pairs) {
  const auto used = pairs.first(std::min(pairs.size(), points_.size()));
  const Eigen::Matrix2d error = kMapError_m * kMapError_m * Eigen::Matrix2d::Identity();
  for (std::size_t k = 0; k < used.size(); ++k) {
    const LandmarkInfo& a = host.map().info(used[k].own);
    const LandmarkInfo& b = guest.map().info(used[k].other);
    points_[k].covariance_a = a.covariance().topLeftCorner<2, 2>() + error;
    points_[k].covariance_b = b.covariance().topLeftCorner<2, 2>() + error;
  }
  for (std::size_t i = 0; i < transforms_.size(); ++i) {
    for (std::size_t k = 0; k < used.size(); ++k) {
      points_[k].a = place(host.map().rows(used[k].own), i);
      points_[k].b = place(guest.map().rows(used[k].other), i);
    }
    const AlignmentFit fit = fit_alignment(points_.first(used.size()), T);
    transforms_[i] = T;
    if (!fit.ok) continue;
    const Eigen::Vector3d off = draw(fit.covariance, host.random());
    transforms_[i] = {fit.T_a_b.x_m + off.x(), fit.T_a_b.y_m + off.y(),
                      wrap_angle(fit.T_a_b.theta_rad + off.z())};
  }
}

void JointFilter::update(std::span<const JointFrame> frames) {
  assert(!frames.empty());
  const int host_robot = leader(frames[0].robot);
  Mapper& host = mapper(host_robot);
  for (const JointFrame& f : frames) {
    assert(leader(f.robot) == host_robot);
    mapper(f.robot).move(f.moved, *f.features);
  }
  host.forget_unseen();
  for (const JointFrame& f : frames) mapper(f.robot).sense(*f.features, *f.view);
  gather(frames);
  update_landmarks(frames, host);
  for (Member& m : members()) {
    if (m.leader == host_robot) m.mapper->estimate();
  }
  for (const JointFrame& f : frames) {
    for (const Candidate& c : mapper(f.robot).candidates()) {
      if (c.inlier) mapper(f.robot).note(c, matched(f, c));
    }
  }
  for (const JointFrame& f : frames) mapper(f.robot).keep();
  start_landmarks(frames);
  if (host.resampling_due()) equalise(host_robot);
  ++steps_;
}

// All matched landmarks of this time step, the sightings of one landmark side by side.
void JointFilter::gather(std::span<const JointFrame> frames) {
  sighting_count_ = 0;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    for (const Candidate& c : mapper(frames[k].robot).candidates()) {
      if (!c.inlier) continue;
      // Another robot's frame may have shown that the landmark is broken.
      if (mapper(frames[k].robot).map().info(c.slot).state == LandmarkState::kFree) continue;
      assert(sighting_count_ < sightings_.size());  // a corner serves one landmark
      if (sighting_count_ == sightings_.size()) break;
      sightings_[sighting_count_++] = {c.slot, static_cast<std::int32_t>(k), &c};
    }
  }
  const auto all = sightings_.first(sighting_count_);
  std::sort(all.begin(), all.end(), [](const Sighting& a, const Sighting& b) {
    return a.slot != b.slot ? a.slot < b.slot : a.frame < b.frame;
  });
}

void JointFilter::update_landmarks(std::span<const JointFrame> frames, Mapper& host) {
  const int n = host.particles().count;
  std::array<StackedObservation, kMaxObservers> observers;
  for (std::size_t start = 0; start < sighting_count_;) {
    const int slot = sightings_[start].slot;
    std::size_t k = 0;
    bool steering = weigh_common_;
    for (; start + k < sighting_count_ && sightings_[start + k].slot == slot; ++k) {
      const Sighting& s = sightings_[start + k];
      const JointFrame& frame = frames[static_cast<std::size_t>(s.frame)];
      const Feature& f = matched(frame, *s.candidate);
      const Eigen::Vector2f z = seen_at(*s.candidate, f);
      observers[k] = {mapper(frame.robot).particles().camera, z.x(), z.y(), s.candidate->noise};
      steering = steering && s.candidate->promoted;
    }
    const LandmarkRows rows = host.map().rows(slot);
    if (k == 1) {
      const StackedObservation& o = observers[0];
      update_landmark(rows, o.camera, n, o.zx, o.zy, o.noise);
    } else {
      update_landmark_stacked(rows, std::span(observers).first(k), n,
                              steering ? host.particles().log_weight.data() : nullptr);
    }
    ++counters_.updates[k];
    start += k;
  }
}

// One robot in a time step, in turn: two that see the same new corner would start it twice.
void JointFilter::start_landmarks(std::span<const JointFrame> frames) {
  const auto first = static_cast<std::size_t>(steps_ % std::max<std::size_t>(frames.size(), 1));
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const JointFrame& f = frames[(k + first) % frames.size()];
    if (!mapper(f.robot).start_due(*f.features)) continue;
    mapper(f.robot).start_landmarks(*f.features);
    return;
  }
}

}  // namespace zenith
