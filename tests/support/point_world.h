#pragma once
// A world of points for the filter's own tests: known landmarks with random looks, exact geometry,
// Gaussian pixel noise, a differential drive with Gaussian wheel noise. No pixels are rendered.

#include <cmath>
#include <vector>

#include "platform/base/random.h"
#include "slam/features.h"
#include "slam/filter/motion.h"
#include "slam/robot.h"

namespace zenith::point_world {

struct PointLandmark {
  Eigen::Vector3d p_m;
  Patch patch;
  CompactPatch compact;
};

inline Patch random_patch(Random& random) {
  Patch patch;
  // Smooth noise: sums of a few waves, so that the compact form keeps it too.
  double waves[6][4];
  for (auto& w : waves) {
    w[0] = random.uniform(-0.7, 0.7);
    w[1] = random.uniform(-0.7, 0.7);
    w[2] = random.uniform(0.0, 6.28);
    w[3] = random.uniform(10.0, 20.0);
  }
  int sum = 0;
  double mean = 0.0;
  double values[kPatchLength];
  for (int i = 0; i < kPatchLength; ++i) {
    values[i] = 0.0;
    for (const auto& w : waves) {
      values[i] += w[3] * std::sin(w[0] * (i % kPatchSize) + w[1] * (i / kPatchSize) + w[2]);
    }
    mean += values[i] / kPatchLength;
  }
  for (int i = 0; i < kPatchLength; ++i) {
    const int q = static_cast<int>(std::lround(values[i] - mean));
    patch.values[static_cast<std::size_t>(i)] = static_cast<std::int8_t>(q);
    sum += q * q;
  }
  patch.inverse_norm = 1.0F / std::sqrt(static_cast<float>(sum));
  return patch;
}

struct PointWorld {
  std::vector<PointLandmark> landmarks;

  // Landmarks scattered over [x0, x1] x [y0, y1], heights in [z0, z1].
  static PointWorld scatter(Random& random, int count, double x0, double x1, double y0, double y1,
                            double z0 = 2.2, double z1 = 3.0) {
    PointWorld world;
    for (int i = 0; i < count; ++i) {
      PointLandmark l;
      l.p_m = {random.uniform(x0, x1), random.uniform(y0, y1), random.uniform(z0, z1)};
      l.patch = random_patch(random);
      l.compact = compact(l.patch);
      world.landmarks.push_back(l);
    }
    return world;
  }

  // What the camera of a robot at `T_world_robot` sees, with `sigma_px` of noise in pixels of
  // the fisheye frame.
  void observe(const Pose2& T_world_robot, const RobotConfig& robot, const Pinhole& pinhole,
               double sigma_px, Random& random, Features& out) const {
    out.clear();
    const Eigen::Vector2d camera =
        T_world_robot * Eigen::Vector2d(robot.mount.x_m, robot.mount.y_m);
    for (const PointLandmark& l : landmarks) {
      const Eigen::Vector2d d = rotation(-T_world_robot.theta_rad) * (l.p_m.head<2>() - camera) /
                                (l.p_m.z() - robot.mount.z_m);
      // Noise of the fisheye frame, as it looks after rectification (see Mapper).
      const double sigma = sigma_px / robot.lens.fu_px * std::pow(1.0 + d.squaredNorm(), 0.75);
      const double nx = sigma * random.normal();
      const double ny = sigma * random.normal();
      const Eigen::Vector2d px = pinhole.pixel(d + Eigen::Vector2d(nx, ny));
      constexpr double kBorder = 13.0;
      if (px.minCoeff() < kBorder || px.maxCoeff() > kRectifiedSize - 1 - kBorder) continue;
      const Eigen::Vector2d m = pinhole.normalise(px.x(), px.y());
      Feature f;
      f.zx = static_cast<float>(m.x());
      f.zy = static_cast<float>(m.y());
      f.u_px = static_cast<float>(px.x());
      f.v_px = static_cast<float>(px.y());
      f.orientation_rad = static_cast<float>(wrap_angle(-T_world_robot.theta_rad));
      f.described = true;
      f.patch = l.patch;
      f.compact = l.compact;
      out.push_back(f);
    }
  }
};

// The travel of two wheels that moves a robot by `v` metres and `w` radians, exactly.
inline WheelTravel wheel_travel(const Wheels& wheels, double v_m, double w_rad) {
  const double half = 0.5 * w_rad * wheels.track_width_m;
  return {(v_m - half) / wheels.left_scale, (v_m + half) / wheels.right_scale};
}

}  // namespace zenith::point_world
