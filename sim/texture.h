#pragma once
// A surface's radiance as an image with mip levels, read with bilinear interpolation.
//
// Texel (i, j) of level 0 covers [i, i+1) x [j, j+1) texels of kTexel_m; level l halves both l
// times with a box filter, so a texture coordinate means the same place on every level.
// Radiance 1 is a white surface in ordinary light; 16 is the largest.

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace zenith::sim {

inline constexpr int kMipLevels = 7;

class Texture {
 public:
  Texture() = default;
  // `radiance` has width * height values, rows of `width`.
  Texture(int width, int height, float texel_m, const std::vector<float>& radiance);

  float texels_per_m() const { return texels_per_m_; }

  // (s, t) in texels of level 0 from the corner of the surface; clamped to its edges.
  float at(int level, float s, float t) const {
    const Level& l = levels_[static_cast<std::size_t>(level)];
    const float x = std::clamp(s * l.scale - 0.5F, 0.0F, l.max_x);
    const float y = std::clamp(t * l.scale - 0.5F, 0.0F, l.max_y);
    const int i = static_cast<int>(x);
    const int j = static_cast<int>(y);
    const float fx = x - static_cast<float>(i);
    const float fy = y - static_cast<float>(j);
    const std::uint16_t* p = texels_.data() + l.start + j * l.stride + i;
    const std::uint16_t* q = p + l.stride;
    const float top = static_cast<float>(p[0]) + fx * static_cast<float>(p[1] - p[0]);
    const float bottom = static_cast<float>(q[0]) + fx * static_cast<float>(q[1] - q[0]);
    return (top + fy * (bottom - top)) * kUnit;
  }

  std::size_t bytes() const { return texels_.size() * sizeof(std::uint16_t); }

 private:
  static constexpr float kUnit = 1.0F / 4096.0F;

  struct Level {
    float scale = 1.0F;  // texels of this level per texel of level 0
    float max_x = 0.0F;  // largest coordinate whose right neighbour exists
    float max_y = 0.0F;
    int stride = 0;  // one texel more than the width, the last one repeated
    int start = 0;
  };

  void append_level(int level, int width, int height, const std::vector<float>& radiance);

  std::array<Level, kMipLevels> levels_ = {};
  std::vector<std::uint16_t> texels_;
  float texels_per_m_ = 100.0F;
};

}  // namespace zenith::sim
