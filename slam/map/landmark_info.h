#pragma once
// What the map knows of a landmark besides its rows of particles.

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "slam/image/patch.h"

namespace zenith {

// Tentative landmarks are tracked until their height is known; promoted ones steer the robot, are
// published and drawn.
enum class LandmarkState : std::uint8_t { kFree, kTentative, kPromoted };

struct LandmarkInfo {
  LandmarkState state = LandmarkState::kFree;
  std::uint32_t id = 0;
  std::int32_t anchor = -1;
  std::int32_t first_appearance = -1;
  std::int32_t appearance_count = 0;
  std::int32_t observations = 0;
  std::int32_t chances = 0;  // frames in which it was predicted well inside the image
  std::int32_t misses_in_row = 0;
  float misfit = 1.0F;  // mean of its matches' misfits: 1 where corners are as sharp as stated
  float kappa = 1.0F;   // NoiseScale's for which its covariance rows are right
  float start_rho_variance = 0.0F;
  float last_residual[2] = {};  // tangents, in the level image's axes
  std::uint64_t last_residual_frame = 0;
  double last_seen_way_m = 0.0;  // Map::way_m() when it was last seen

  // Weighted over the particles when it was last brought up to date; own start frame.
  float x_m = 0.0F;
  float y_m = 0.0F;
  float z_m = 0.0F;
  float covariance_m2[6] = {};  // xx xy xz yy yz zz
  float rho = 0.0F;
  float rho_sigma = 0.0F;

  // Publication: what peers were last told, to tell them again only when it matters.
  std::uint32_t revision = 0;
  bool changed = false;
  float published_x_m = 0.0F;
  float published_y_m = 0.0F;
  float published_z_m = 0.0F;
  float published_trace_m2 = 0.0F;
  std::int32_t published_appearances = 0;

  Eigen::Vector3d position_m() const { return {x_m, y_m, z_m}; }
  Eigen::Matrix3d covariance() const {
    const float* c = covariance_m2;
    return (Eigen::Matrix3d() << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5]).finished();
  }
};

// One look of a landmark, in a pool that all landmarks share.
struct Appearance {
  static constexpr float kCentreStep_px = 1.0F / 64.0F;

  Patch patch;
  CompactPatch compact;
  // Where the landmark lies in the patch, from its centre, in steps: a look that was added later is
  // of a corner that lay beside it.
  std::array<std::int8_t, 2> centre = {};
  float direction_rad = 0.0F;  // of the patch's orientation in the own start frame
  std::int32_t next = -1;      // of the same landmark, or of the free list

  Eigen::Vector2f centre_px() const {
    return kCentreStep_px *
           Eigen::Vector2f(static_cast<float>(centre[0]), static_cast<float>(centre[1]));
  }
};

}  // namespace zenith
