// What keeps the mapper's numbers within slam/bounds.h, in every build. Each check runs once after
// the phase that may have broken something: some instructions for each particle, and for each
// landmark that was touched. The repair is the smallest that is right:
//
//   the wheels' travel      counts as none
//   a particle's pose       the heaviest particle's, without weight: the next resampling ends it
//   all particles' poses    scattered around the last mean
//   a weight, all weights   normalise_weights()
//   the frame's correction  dropped: matches of promoted landmarks do not count in this frame
//   the calibration         learned from the start, the learned value stays
//   a landmark              dropped, as if it had been pruned
//   the map                 reset, once all poses broke in kResetsOfAMap used frames in a row
//
// As long as nothing is broken nothing is changed, bit for bit.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "slam/bounds.h"
#include "slam/mapper.h"

namespace zenith {
namespace {

constexpr int kResetsOfAMap = 3;
constexpr double kRoundingOfSum = 1e-6;
constexpr double kScatter_m = 0.05;
constexpr double kScatter_rad = 0.02;
// What the calibration may move the pose by in a frame: the rest follows in the next ones.
constexpr double kMostMove_m = 0.02;
constexpr double kMostTurn_rad = 0.005;

}  // namespace

void Mapper::set_motion(const MotionIncrement& moved) {
  const MotionIncrement all = undrawn_ * moved;
  bool usable = true;
  for (const MotionIncrement& m : {moved, all}) {
    usable = usable && is_within(m.mean.x_m, kFarthest_m) && is_within(m.mean.y_m, kFarthest_m) &&
             is_within(m.mean.theta_rad, kFarthest_m) && is_covariance(m.covariance);
  }
  motion_ = usable ? all : undrawn_;
  undrawn_ = motion_;
  moved_ = usable ? moved.mean : Pose2{};
  if (!usable) ++counters_.repairs.travels_refused;
  const double way = std::hypot(moved_.x_m, moved_.y_m);
  travelled_m_ += way;
  drift_travel_m_ += way;
  map_->add_way(way_share_ * way);
}

void Mapper::check_poses() {
  const auto weight = [this](int i) { return particles_.weight[static_cast<std::size_t>(i)]; };
  int broken = 0;
  double sum = 0.0;
  for (int i = 0; i < particles_.count; ++i) {
    broken += is_usable(particles_.pose(i)) ? 0 : 1;
    sum += weight(i);
  }
  if (!is_within(sum - 1.0, kRoundingOfSum)) {
    ++counters_.repairs.weights_zeroed;
    effective_ = normalise_weights(particles_, counters_.repairs);
  }
  if (broken == 0) return;
  if (broken == particles_.count) return reset_poses();
  int heaviest = -1;
  for (int i = 0; i < particles_.count; ++i) {
    if (!is_usable(particles_.pose(i))) continue;
    if (heaviest < 0 || weight(i) > weight(heaviest)) heaviest = i;
  }
  for (int i = 0; i < particles_.count; ++i) {
    if (is_usable(particles_.pose(i))) continue;
    particles_.set_pose(i, particles_.pose(heaviest));
    particles_.log_weight[static_cast<std::size_t>(i)] = -std::numeric_limits<double>::infinity();
    ++counters_.repairs.particles_moved;
  }
  effective_ = normalise_weights(particles_, counters_.repairs);
}

void Mapper::reset_poses() {
  const Pose2 around = is_usable(pose_.mean) ? pose_.mean : Pose2{};
  for (int i = 0; i < particles_.count; ++i) {
    const double x = kScatter_m * random_.normal();
    const double y = kScatter_m * random_.normal();
    const double turn = kScatter_rad * random_.normal();
    particles_.set_pose(i, around * Pose2{x, y, turn});
    particles_.log_weight[static_cast<std::size_t>(i)] = 0.0;
  }
  effective_ = normalise_weights(particles_, counters_.repairs);
  poses_broke_ = true;
  ++counters_.repairs.poses_reset;
}

void Mapper::check_correction() {
  if (correction_.broken) ++counters_.repairs.corrections_dropped;
}

// Of particles that lie within the bounds mean and covariance do, too: what is left to break the
// covariance is what the calibration adds.
void Mapper::check_estimate() {
  if (is_covariance(pose_.covariance)) return;
  restart_calibration();
  pose_.covariance = estimate_pose(particles_).covariance;
}

void Mapper::finish_calibration() {
  calibration_.end_frame();
  if (calibration_.broken()) return restart_calibration();
  const Eigen::Vector3d move = pose_by_calibration_ * calibration_.owed();
  const double steps =
      std::max(move.head<2>().norm() / kMostMove_m, std::abs(move.z()) / kMostTurn_rad);
  move_by_calibration(calibration_.pay(1.0 / std::max(steps, 1.0)));
}

void Mapper::restart_calibration() {
  calibration_.restart();
  pose_by_calibration_.setZero();
  ++counters_.repairs.calibrations_reset;
}

void Mapper::drop_landmark(int slot) {
  map_->remove(slot);
  ++counters_.repairs.landmarks_dropped;
}

bool Mapper::refresh_place(int slot) {
  if (map_->refresh_place(slot, particles_.weight.data(), robot_.mount.z_m)) return true;
  drop_landmark(slot);
  return false;
}

void Mapper::check_map() {
  resets_in_row_ = std::exchange(poses_broke_, false) ? resets_in_row_ + 1 : 0;
  if (resets_in_row_ < kResetsOfAMap || map_ != &own_map_) return;
  resets_in_row_ = 0;
  begin_anew();
  ++counters_.repairs.maps_reset;
}

}  // namespace zenith
