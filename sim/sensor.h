#pragma once
// From radiance to 8-bit pixels.
//
//   blurred = radiance * [a, 1 - 2a, a]^T [a, 1 - 2a, a],  a = blur_px^2 / 2       the lens
//   electrons e = exposure * blurred,  plus noise of variance e + read^2           shot, read
//   pixel = round(255 e / full_well), linear, clipped to 0..255
//
// The response is linear (no gamma). At EV 0 radiance 1 gives 200.

#include <cstdint>
#include <vector>

#include "platform/base/random.h"
#include "sim/world_file.h"

namespace zenith::sim {

class Sensor {
 public:
  Sensor(const CameraSpec& camera, double exposure_ev);

  // `radiance` has rows of the lens's width. `random` decides the noise of this frame.
  void develop(const std::vector<float>& radiance, Random& random,
               std::vector<std::uint8_t>& pixels);

 private:
  std::size_t width_;
  std::size_t height_;
  float gain_;  // pixel values per radiance
  float side_;  // a
  float values_per_e_;
  float read_variance_;  // pixel values squared
  std::vector<float> normal_;
  std::vector<float> column_blurred_;  // one row, and one zero at each end
};

}  // namespace zenith::sim
