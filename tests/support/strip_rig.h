#pragma once
// A robot that maps a long strip of ceiling, the end of which is the same for every length, point
// for point. No pixels: the world of points of the filter's tests. All that a Slam has but for the
// wheels' history.

#include <cmath>
#include <span>
#include <vector>

#include "slam/fleet/fleet.h"
#include "slam/fleet/publish.h"
#include "slam/mapper.h"
#include "slam/observed.h"
#include "tests/support/arena_block.h"
#include "tests/support/point_world.h"

namespace zenith::strip {

using point_world::PointWorld;

inline constexpr double kPerMetre = 11.0;    // landmarks: about 80 are in view
inline constexpr double kHalfWidth_m = 3.0;  // of the strip
inline constexpr double kEnd_m = 4.0;        // from the last stand to the strip's end
inline constexpr double kFillStep_m = 0.20;
// Fewer anchors than by default: kMaxAnchors must last for the whole strip.
inline constexpr double kAnchorDistance_m = 0.5;
inline constexpr double kStep_m = 0.05;
inline constexpr int kStepsToAndFro = 20;
inline constexpr double kPixelSigma_px = 0.5;

// Landmark i lies i / kPerMetre before the strip's end; `length_m` is where the end is.
inline PointWorld make_strip(int landmarks, double length_m) {
  Random random(5);
  PointWorld world;
  for (int i = 0; i < landmarks; ++i) {
    point_world::PointLandmark l;
    const double back_m = (i + random.uniform()) / kPerMetre;
    l.p_m.x() = length_m - back_m;
    l.p_m.y() = random.uniform(-kHalfWidth_m, kHalfWidth_m);
    l.p_m.z() = random.uniform(2.2, 3.0);
    l.patch = point_world::random_patch(random);
    l.compact = compact(l.patch);
    world.landmarks.push_back(l);
  }
  return world;
}

inline Parameters strip_parameters() {
  Parameters parameters;
  parameters.anchor_distance_m = kAnchorDistance_m;
  return parameters;
}

class StripRig {
 public:
  explicit StripRig(int landmarks)
      : parameters_(strip_parameters()), block_([this](Arena& arena) {
          view_.layout(arena);
          mapper_.layout(arena, parameters_);
          fleet_.layout(arena);
          features_ = arena.take<Features>(1);
          observed_ = arena.take<ObservedFrame>(1);
          records_ = arena.take<LandmarkRecord>(64);
        }) {
    view_.build(robot_, parameters_);
    mapper_.build(robot_, parameters_, 1);
    fleet_.build(parameters_);
    // The robot starts at the origin, kEnd_m behind the strip's beginning.
    const double length_m = landmarks / kPerMetre - kEnd_m;
    world_ = make_strip(landmarks, length_m);
    drive(0.0);
    while (x_m_ < length_m - kEnd_m) drive(kFillStep_m);
    for (int i = 0; i < 2 * kStepsToAndFro; ++i) drive(next_step());
  }

  // The part before the step under test, and the step.
  void look(double way_m) {
    x_m_ += way_m;
    moved_ = motion_increment(robot_.wheels, point_world::wheel_travel(robot_.wheels, way_m, 0.0),
                              mapper_.motion_noise());
    world_.observe({x_m_, 0.0, 0.0}, robot_, view_.pinhole(), kPixelSigma_px, random_,
                   features_[0]);
  }
  void update() { mapper_.update(moved_, features_[0], view_); }
  void cooperate() {
    observe(mapper_, features_[0], observed_[0]);
    const std::size_t told = publish_changes(mapper_.map(), records_);
    fleet_.receive_own(records_.first(told));
    fleet_.update(observed_[0], mapper_.map(), mapper_.pose().mean, mapper_.travelled_m());
  }
  double next_step() { return ++to_and_fro_ / kStepsToAndFro % 2 == 0 ? -kStep_m : kStep_m; }

  Fleet& fleet() { return fleet_; }
  const Mapper& mapper() const { return mapper_; }
  const PointWorld& world() const { return world_; }
  int map_size() { return mapper_.map().size(); }
  std::size_t candidates() { return mapper_.candidates().size(); }
  double error_m() const {
    return std::hypot(mapper_.pose().mean.x_m - x_m_, mapper_.pose().mean.y_m);
  }

 private:
  void drive(double way_m) {
    look(way_m);
    update();
    cooperate();
  }

  Parameters parameters_;
  RobotConfig robot_;
  FeatureExtractor view_;
  Mapper mapper_;
  Fleet fleet_;
  std::span<Features> features_;
  std::span<ObservedFrame> observed_;
  std::span<LandmarkRecord> records_;
  PointWorld world_;
  Random random_{6};
  MotionIncrement moved_;
  double x_m_ = 0.0;
  int to_and_fro_ = 0;
  ArenaBlock block_;
};

}  // namespace zenith::strip
