#include "sim/sensor.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace zenith::sim {
namespace {

constexpr double kValueOfWhite = 170.0;
constexpr std::uint32_t kTableSize = 1u << 16u;
constexpr int kMaxWidth = 4096;

}  // namespace

Sensor::Sensor(const CameraSpec& camera, double exposure_ev)
    : gain_(static_cast<float>(kValueOfWhite * std::exp2(exposure_ev))),
      values_per_e_(static_cast<float>(255.0 / camera.full_well_e)),
      read_variance_(static_cast<float>(camera.read_noise_e * camera.read_noise_e)),
      normal_(kTableSize + kMaxWidth) {
  Random random(20'240'229);
  for (float& value : normal_) value = static_cast<float>(random.normal());
}

void Sensor::develop(std::span<const float> radiance, int width, Random& random,
                     std::vector<std::uint8_t>& pixels) const {
  assert(width > 0 && width <= kMaxWidth);
  pixels.resize(radiance.size());
  const float variance_per_value = values_per_e_;
  const float read = read_variance_ * values_per_e_ * values_per_e_;
  for (std::size_t start = 0; start < radiance.size(); start += static_cast<std::size_t>(width)) {
    // Each row reads the table of normal numbers from a random place.
    const float* noise = normal_.data() + random.below(kTableSize);
    const float* in = radiance.data() + start;
    std::uint8_t* out = pixels.data() + start;
    for (int i = 0; i < width; ++i) {
      const float mean = in[i] * gain_;
      const float value = mean + noise[i] * std::sqrt(mean * variance_per_value + read) + 0.5F;
      out[i] = static_cast<std::uint8_t>(static_cast<int>(std::clamp(value, 0.0F, 255.0F)));
    }
  }
}

}  // namespace zenith::sim
