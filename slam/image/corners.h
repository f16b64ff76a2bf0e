#pragma once
// Sub-pixel Harris corners, spread over the image (paper IV).
//
//   A = sum over a Gaussian window of [Ix^2, Ix Iy; Ix Iy, Iy^2],  response = det A - k (tr A)^2
//
// Source: Harris, Stephens, "A combined corner and edge detector", 1988. Gradients are Scharr's, in
// grey levels per pixel; the window is a binomial of 7 x 7 (sigma 1.22), nearly isotropic, so that
// a corner keeps its place in it when the robot turns. The peak is refined by a quadratic.

#include <cstdint>
#include <span>

#include "platform/base/arena.h"
#include "platform/base/fixed_vector.h"
#include "slam/capacity.h"
#include "slam/image/image.h"

namespace zenith {

struct Corner {
  float u_px = 0.0F;
  float v_px = 0.0F;
  float response = 0.0F;
};

using Corners = FixedVector<Corner, kMaxCorners>;

struct CornerSettings {
  double min_eigenvalue = 2.0;  // weaker corners are noise; (grey levels / px)^2
  double min_distance_px = 6.0;
  int max_corners = kMaxCorners;
  int per_cell = 3;    // at most, in a cell of 32 x 32 pixels: the spread
  int border_px = 13;  // room for a rotated patch; at least kHarrisEdge
};

class CornerDetector {
 public:
  void layout(Arena& arena);
  // `corners` in falling response.
  void detect(const ImageView& image, const CornerSettings& settings, Corners& corners);

 private:
  void refine_peaks(int border_px);
  bool take(const Corner& peak, const CornerSettings& settings, Corners& corners) const;

  std::span<float> response_;
  std::span<float> scratch_;
  std::span<std::int32_t> places_;  // of the local maxima
  std::span<Corner> peaks_;
  std::size_t peak_count_ = 0;
};

}  // namespace zenith
