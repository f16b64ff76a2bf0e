#pragma once
// What robots tell each other: their own landmarks as versioned records, plain data.
// A robot publishes only what it saw itself, so that no information is counted twice.

#include <array>
#include <cstdint>

#include "slam/capacity.h"

namespace zenith {

// One look of a landmark: the 32 low-frequency DCT coefficients of its orientation-normalised
// patch, unit norm scaled to int8, and the direction that was rotated away, in the publisher's map
// frame: two robots' directions of the same patch differ by the rotation between their maps.
struct AppearanceRecord {
  std::array<std::int8_t, kCompactLength> descriptor = {};
  float direction_rad = 0.0F;
};

// Position and covariance are in the publisher's own map frame, metres. The highest revision of an
// id wins; a removed landmark is a record too.
struct LandmarkRecord {
  std::uint32_t id = 0;
  std::uint32_t revision = 0;
  bool removed = false;
  float x_m = 0.0F;
  float y_m = 0.0F;
  float z_m = 0.0F;
  std::array<float, 6> covariance_m2 = {};  // xx xy xz yy yz zz
  std::uint16_t observations = 0;
  std::uint8_t appearance_count = 0;
  std::array<AppearanceRecord, kPublishedAppearances> appearances = {};
};

}  // namespace zenith
