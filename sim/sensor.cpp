#include "sim/sensor.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace zenith::sim {
namespace {

constexpr double kValueOfWhite = 200.0;
constexpr std::uint32_t kTableSize = 1u << 16u;

}  // namespace

Sensor::Sensor(const CameraSpec& camera, double exposure_ev)
    : width_(static_cast<std::size_t>(camera.lens.width_px)),
      height_(static_cast<std::size_t>(camera.lens.height_px)),
      gain_(static_cast<float>(kValueOfWhite * std::exp2(exposure_ev))),
      side_(static_cast<float>(0.5 * camera.blur_px * camera.blur_px)),
      values_per_e_(static_cast<float>(255.0 / camera.full_well_e)),
      read_variance_(
          static_cast<float>(std::pow(camera.read_noise_e * 255.0 / camera.full_well_e, 2.0))),
      normal_(kTableSize + width_),
      column_blurred_(width_ + 2, 0.0F) {
  Random random(20'240'229);
  for (float& value : normal_) value = static_cast<float>(random.normal());
}

void Sensor::develop(const std::vector<float>& radiance, Random& random,
                     std::vector<std::uint8_t>& pixels) {
  assert(radiance.size() == width_ * height_);
  pixels.resize(radiance.size());
  const float centre = 1.0F - 2.0F * side_;
  float* blurred = column_blurred_.data() + 1;
  for (std::size_t row = 0; row < height_; ++row) {
    const float* in = radiance.data() + row * width_;
    const float* above = row > 0 ? in - width_ : in;
    const float* below = row + 1 < height_ ? in + width_ : in;
    for (std::size_t i = 0; i < width_; ++i) {
      blurred[i] = gain_ * (centre * in[i] + side_ * (above[i] + below[i]));
    }
    // Each row reads the table of normal numbers from a random place.
    const float* noise = normal_.data() + random.below(kTableSize);
    std::uint8_t* out = pixels.data() + row * width_;
    const float* b = column_blurred_.data();
    for (std::size_t i = 0; i < width_; ++i) {
      const float mean = centre * b[i + 1] + side_ * (b[i] + b[i + 2]);
      const float sigma = std::sqrt(mean * values_per_e_ + read_variance_);
      const float value = std::clamp(mean + noise[i] * sigma + 0.5F, 0.0F, 255.0F);
      out[i] = static_cast<std::uint8_t>(static_cast<int>(value));
    }
  }
}

}  // namespace zenith::sim
