#pragma once
// A Mapper in the world of points: its memory, its robot, and a drive whose wheel and pixel noise
// are exactly those that the parameters state.

#include "slam/mapper.h"
#include "tests/support/arena_block.h"
#include "tests/support/point_world.h"

namespace zenith::point_world {

class MapperRig {
 public:
  MapperRig(const RobotConfig& robot, const Parameters& parameters, std::uint64_t seed)
      : parameters_(parameters), block_([&](Arena& arena) {
          view_.layout(arena);
          mapper_.layout(arena, parameters);
          features_ = arena.take<Features>(1);
        }) {
    view_.build(robot, parameters);
    mapper_.build(robot, parameters, seed);
  }

  // The robot moves by `step` as its wheels tell it, plus noise after the motion model, looks at
  // the ceiling, and the mapper is told. The first frame
  // is the start frame: call it with no motion. `told` is the share of it that the wheels tell,
  // `noisier` how many times noisier corners are than the parameters say.
  void drive(const Pose2& commanded, const PointWorld& world, Random& random, double told = 1.0,
             double noisier = 1.0) {
    const Wheels& wheels = mapper_.robot().wheels;
    WheelTravel travel = wheel_travel(wheels, commanded.x_m, commanded.theta_rad);
    const MotionNoise noise = {parameters_.distance_noise_per_sqrt_m,
                               parameters_.turn_noise_per_sqrt_m,
                               parameters_.lateral_noise_per_sqrt_m, parameters_.odometry_floor_m};
    const MotionIncrement motion = motion_increment(wheels, travel, noise);
    const Eigen::Vector3d sigma = motion.covariance.diagonal().cwiseSqrt();
    const double forward = sigma.x() * random.normal();
    const double left = sigma.y() * random.normal();
    const double turn = sigma.z() * random.normal();
    truth_ = truth_ * motion.mean * Pose2{forward, left, turn};
    world.observe(truth_, mapper_.robot(), view_.pinhole(), noisier * parameters_.pixel_sigma_px,
                  random, features_[0]);
    if (told != 1.0) {
      travel = wheel_travel(wheels, told * commanded.x_m, told * commanded.theta_rad);
    }
    mapper_.update(motion_increment(wheels, travel, noise), features_[0], view_);
  }

  Mapper& mapper() { return mapper_; }
  const Mapper& mapper() const { return mapper_; }
  const FeatureExtractor& view() const { return view_; }
  Features& features() { return features_[0]; }
  const Pose2& truth() const { return truth_; }

  // Estimate minus truth over (x, y, theta).
  Eigen::Vector3d error() const {
    const Pose2& estimate = mapper_.pose().mean;
    return {estimate.x_m - truth_.x_m, estimate.y_m - truth_.y_m,
            wrap_angle(estimate.theta_rad - truth_.theta_rad)};
  }

 private:
  Parameters parameters_;
  FeatureExtractor view_;
  Mapper mapper_;
  std::span<Features> features_;
  ArenaBlock block_;
  Pose2 truth_;
};

}  // namespace zenith::point_world
