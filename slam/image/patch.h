#pragma once
// What a corner looks like: an orientation-normalised patch, in full and in compact form.
//
// Orientation is the direction from the corner to the intensity centroid of a disc around it
// (Rosin, "Measuring corner properties", 1999); the patch is sampled with that direction turned to
// the x axis, so that it looks the same from every heading (paper III-A).
// The full form is the patch made zero-mean; the compact form its low-frequency DCT coefficients
// without the constant one. Both are int8 scaled to their largest value, with the inverse norm
// beside them: NCC(a, b) = a.b * inverse_norm(a) * inverse_norm(b).

#include <array>
#include <cstdint>

#include "slam/capacity.h"
#include "slam/image/image.h"
#include "slam/kernels/match/exact_search.h"

namespace zenith {

struct Patch {
  std::array<std::int8_t, kPatchLength> values = {};
  float inverse_norm = 0.0F;  // 0: a patch without contrast, similar to nothing
};

struct CompactPatch {
  std::array<std::int8_t, kCompactLength> values = {};
  float inverse_norm = 0.0F;
};

// Direction of the intensity centroid within 8 pixels, radians in the image's axes.
float patch_orientation(const ImageView& image, float u_px, float v_px);

// The patch around (u, v), turned back by `orientation_rad`. At least 12 pixels from every edge of
// the image.
Patch sample_patch(const ImageView& image, float u_px, float v_px, float orientation_rad);

// The first kCompactLength coefficients of the orthonormal 2D DCT-II, in zigzag order, without the
// constant one.
CompactPatch compact(const Patch& patch);

// How much of a patch its compact form tells, for the exact search. Nothing of one without
// contrast.
Outline outline(const Patch& patch, const CompactPatch& compact);

// 1 / |values|, 0 for all zeros: what a received descriptor needs to become a CompactPatch.
CompactPatch compact_from(const std::array<std::int8_t, kCompactLength>& values);

}  // namespace zenith
