#pragma once
// From radiance to 8-bit pixels.
//
//   electrons e = exposure * radiance,  plus noise of variance e + read^2 (shot and read noise)
//   pixel = round(255 e / full_well), linear, clipped to 0..255
//
// The response is linear (no gamma). At EV 0 radiance 1 gives 170.

#include <cstdint>
#include <span>
#include <vector>

#include "platform/base/random.h"
#include "sim/world_file.h"

namespace zenith::sim {

class Sensor {
 public:
  Sensor(const CameraSpec& camera, double exposure_ev);

  // `random` decides the noise of this frame.
  void develop(std::span<const float> radiance, int width, Random& random,
               std::vector<std::uint8_t>& pixels) const;

 private:
  float gain_;           // pixel values per radiance
  float values_per_e_;
  float read_variance_;  // electrons squared
  std::vector<float> normal_;
};

}  // namespace zenith::sim
