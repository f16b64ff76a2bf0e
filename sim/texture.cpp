#include "sim/texture.h"

#include <cassert>

namespace zenith::sim {
namespace {

// Half the size, rounded up; the odd last texel repeats.
std::vector<float> halve(const std::vector<float>& in, int width, int height) {
  const int w = (width + 1) / 2;
  const int h = (height + 1) / 2;
  std::vector<float> out(static_cast<std::size_t>(w) * h);
  for (int j = 0; j < h; ++j) {
    const float* top = in.data() + static_cast<std::size_t>(2 * j) * width;
    const float* bottom = 2 * j + 1 < height ? top + width : top;
    float* row = out.data() + static_cast<std::size_t>(j) * w;
    for (int i = 0; i < w; ++i) {
      const int left = 2 * i;
      const int right = std::min(left + 1, width - 1);
      row[i] = 0.25F * (top[left] + top[right] + bottom[left] + bottom[right]);
    }
  }
  return out;
}

}  // namespace

Texture::Texture(int width, int height, float texel_m, const std::vector<float>& radiance)
    : texels_per_m_(1.0F / texel_m) {
  assert(width > 0 && height > 0);
  assert(radiance.size() == static_cast<std::size_t>(width) * height);
  append_level(0, width, height, radiance);
  std::vector<float> smaller = radiance;
  for (int level = 1; level < kMipLevels; ++level) {
    smaller = halve(smaller, width, height);
    width = (width + 1) / 2;
    height = (height + 1) / 2;
    append_level(level, width, height, smaller);
  }
}

void Texture::append_level(int level, int width, int height, const std::vector<float>& radiance) {
  Level& l = levels_[static_cast<std::size_t>(level)];
  l.scale = 1.0F / static_cast<float>(1 << level);
  l.max_x = static_cast<float>(width - 1);
  l.max_y = static_cast<float>(height - 1);
  l.stride = width + 1;
  l.start = static_cast<int>(texels_.size());
  texels_.reserve(texels_.size() + static_cast<std::size_t>(l.stride) * (height + 1));
  for (int j = 0; j <= height; ++j) {
    const float* row = radiance.data() + static_cast<std::size_t>(std::min(j, height - 1)) * width;
    for (int i = 0; i <= width; ++i) {
      const float value = std::clamp(row[std::min(i, width - 1)] / kUnit + 0.5F, 0.0F, 65535.0F);
      texels_.push_back(static_cast<std::uint16_t>(value));
    }
  }
}

}  // namespace zenith::sim
