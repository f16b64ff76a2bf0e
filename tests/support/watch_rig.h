#pragma once
// A SetupWatch on a robot that drives under points: exact geometry, noise of pixels and wheels, and
// everything that can be wrong with a set-up or go wrong on the way. No pixels are rendered.

#include <functional>
#include <vector>

#include "slam/watch/setup_watch.h"
#include "tests/support/point_world.h"

namespace zenith::point_world {

// What differs from a right set-up.
struct SetupFaults {
  bool mirrored = false;       // columns
  double mount_yaw_rad = 0.0;  // of the true mount, and of the one that is told
  double yaw_error_rad = 0.0;  // told less true
  double tilt_rad = 0.0;       // the rectified image is tilted by so much
  double focal_error = 0.0;    // right focal length by the told one, less 1; equidistant
  double axis_ahead = 0.0;     // principal point, right less told, in focal lengths
  double wheels_late_s = 0.0;
  double jitter_s = 0.0;     // of the frames' stamps
  double left_factor = 1.0;  // what the wheels tell, by what they travelled
  double right_factor = 1.0;
  bool swapped = false;
  bool backward = false;  // the robot drives backward all the time
  int standing = 0;       // corners that are of the robot itself
};

class WatchRig {
 public:
  static constexpr double kPeriod_s = 0.1;

  WatchRig(const SetupFaults& faults, std::uint64_t seed)
      : faults_(faults),
        random_(seed),
        world_(PointWorld::scatter(random_, 900, -7.0, 7.0, -7.0, 7.0, 2.5, 2.6)) {
    robot_.mount.x_m = 0.06;
    robot_.mount.y_m = -0.02;
    robot_.mount.yaw_rad = faults.mount_yaw_rad;
    watch_.build(robot_);
    for (int i = 0; i < faults.standing; ++i) {
      PointLandmark l;
      l.p_m = {random_.uniform(0.3, 0.7), random_.uniform(0.3, 0.7), 0.0};
      l.patch = random_patch(random_);
      l.compact = compact(l.patch);
      own_.push_back(l);
    }
  }

  // `speed` in m/s and rad/s for so long. `wheels_too`: whether the wheels tell of it; `moves`:
  // whether the robot does.
  void drive(double duration_s, double speed, double turn_rate, bool wheels_too = true,
             bool moves = true) {
    const int steps = static_cast<int>(std::lround(duration_s / kPeriod_s));
    for (int i = 0; i < steps; ++i) step(speed, turn_rate, wheels_too, moves);
  }

  // Turns and straights, some 1.4 m and 70 degrees each, back and forth.
  void drive_about(int legs) {
    const double way = faults_.backward ? -0.35 : 0.35;
    for (int i = 0; i < legs; ++i) {
      drive(4.0, way, 0.0);
      drive(2.0, 0.4 * way, (i % 3 == 0 ? -0.6 : 0.6));
    }
  }

  // Stands somewhere else from the next frame on.
  void put_down(const Pose2& at) { pose_ = at; }
  // The next frames show the same picture.
  bool picture_held = false;
  bool dark = false;

  const SetupVerdict& verdict() const { return watch_.verdict(); }
  DelayedFits fits() const { return watch_.fits(); }
  const SetupMeasures& measures() const { return watch_.measures(); }
  bool says(SetupCode code) const { return gives(verdict(), code); }
  std::string reasons() const {
    std::string text = std::string(verdict_name(verdict().state)) + ":";
    for (const Reason& r : verdict().reasons) {
      text += " " + std::string(setup_code_name(r.code)) + " (" + std::to_string(r.value) + ")";
    }
    return text;
  }

 private:
  void step(double speed, double turn_rate, bool wheels_too, bool moves) {
    constexpr int kSamples = 5;
    for (int i = 1; i <= kSamples; ++i) {
      const double dt = kPeriod_s / kSamples;
      const WheelTravel t = wheel_travel(robot_.wheels, speed * dt, turn_rate * dt);
      if (moves) pose_ = pose_ * wheel_motion(robot_.wheels, t);
      if (wheels_too) {
        total_.left_m += t.left_m + 2e-4 * random_.normal();
        total_.right_m += t.right_m + 2e-4 * random_.normal();
      }
      WheelTravel told = {faults_.left_factor * total_.left_m,
                          faults_.right_factor * total_.right_m};
      if (faults_.swapped) std::swap(told.left_m, told.right_m);
      const Time stamp = now_ + Duration::from_seconds(i * dt + faults_.wheels_late_s);
      wheels_.add({stamp, told.left_m, told.right_m});
    }
    now_ = now_ + Duration::from_seconds(kPeriod_s);
    if (!picture_held) see();
    std::fill(image_.begin(), image_.end(), static_cast<std::uint8_t>(dark ? 5 : 100));
    const Time stamp = now_ + Duration::from_seconds(faults_.jitter_s * random_.normal());
    const ImageView view = {image_.data(), kRectifiedSize, kRectifiedSize, kRectifiedSize};
    watch_.observe({stamp, features_.span(), view, picture_held}, wheels_);
  }

  void see() {
    features_.clear();
    if (dark) return;
    for (const PointLandmark& l : own_) add({l.p_m.x(), l.p_m.y()}, 0.0F, l);
    Features seen;
    world_.observe(pose_, robot_, pinhole_, 0.3, random_, seen);
    for (const Feature& f : seen) {
      Feature changed = f;
      Eigen::Vector2d m(f.zx, f.zy);
      double direction = f.orientation_rad;
      if (faults_.mirrored) {
        // Columns run along the direction of the mount's yaw.
        const double across = 2.0 * (faults_.mount_yaw_rad + 0.5 * std::numbers::pi);
        const Eigen::Vector2d r = rotation(across) * Eigen::Vector2d(m.x(), -m.y());
        m = r;
        direction = wrap_angle(across - direction);
      }
      m = rotation(faults_.yaw_error_rad) * m;
      direction = wrap_angle(direction + faults_.yaw_error_rad);
      const double c = std::cos(faults_.tilt_rad);
      const double s = std::sin(faults_.tilt_rad);
      m = by_told_lens(m);
      const double z = c - s * m.x();
      m = {(c * m.x() + s) / z, m.y() / z};
      changed.zx = static_cast<float>(m.x());
      changed.zy = static_cast<float>(m.y());
      changed.orientation_rad = static_cast<float>(direction);
      features_.push_back(changed);
    }
  }

  // Where a right ray of an equidistant lens is taken to be.
  Eigen::Vector2d by_told_lens(const Eigen::Vector2d& m) const {
    const double r = m.norm();
    Eigen::Vector2d image = r < 1e-9 ? m : Eigen::Vector2d(std::atan(r) / r * m);
    image = (1.0 + faults_.focal_error) * image + Eigen::Vector2d(faults_.axis_ahead, 0.0);
    const double theta = image.norm();
    return theta < 1e-9 ? image : Eigen::Vector2d(std::tan(theta) / theta * image);
  }

  void add(const Eigen::Vector2d& m, float direction, const PointLandmark& l) {
    Feature f;
    f.zx = static_cast<float>(m.x() + 0.001 * random_.normal());
    f.zy = static_cast<float>(m.y() + 0.001 * random_.normal());
    f.orientation_rad = direction;
    f.described = true;
    f.patch = l.patch;
    f.compact = l.compact;
    features_.push_back(f);
  }

  SetupFaults faults_;
  Random random_;
  PointWorld world_;
  std::vector<PointLandmark> own_;
  RobotConfig robot_;
  Pinhole pinhole_ = Pinhole::from_fov(112.0 * std::numbers::pi / 180.0);
  SetupWatch watch_;
  WheelHistory wheels_;
  Pose2 pose_;
  WheelTravel total_;
  Time now_ = {1'000'000'000};
  Features features_;
  std::vector<std::uint8_t> image_ =
      std::vector<std::uint8_t>(std::size_t{kRectifiedSize} * kRectifiedSize, 0);
};

}  // namespace zenith::point_world
