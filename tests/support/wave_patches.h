#pragma once
// Random patches that are smooth as those of real ceilings: a wave of each frequency of the patch,
// weaker as it gets shorter.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "platform/base/random.h"
#include "slam/image/patch.h"

namespace zenith {

using PatchValues = std::array<float, kPatchLength>;

// As Patch says: of largest magnitude 127. `values` are zero-mean already, or nearly.
inline Patch quantised(const PatchValues& values) {
  float largest = 0.0F;
  for (const float v : values) largest = std::max(largest, std::abs(v));
  Patch patch;
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size() && largest > 0.0F; ++i) {
    patch.values[i] = static_cast<std::int8_t>(std::lround(127.0F * values[i] / largest));
    squares += patch.values[i] * patch.values[i];
  }
  if (squares > 0.0) patch.inverse_norm = static_cast<float>(1.0 / std::sqrt(squares));
  return patch;
}

// After its values were changed.
inline Patch requantised(const Patch& patch) {
  PatchValues values;
  std::copy(patch.values.begin(), patch.values.end(), values.begin());
  return quantised(values);
}

inline PatchValues random_waves(Random& random) {
  struct Cosines {
    float at[kPatchSize][kPatchSize];
    Cosines() {
      for (int f = 0; f < kPatchSize; ++f) {
        for (int i = 0; i < kPatchSize; ++i) {
          at[f][i] = static_cast<float>(std::cos(std::numbers::pi * f * (i + 0.5) / kPatchSize));
        }
      }
    }
  };
  static const Cosines wave;
  PatchValues values = {};
  for (int fv = 0; fv < kPatchSize; ++fv) {
    for (int fu = 0; fu < kPatchSize; ++fu) {
      if (fu + fv == 0) continue;
      const auto amplitude = static_cast<float>(random.normal() / (fu * fu + fv * fv));
      std::size_t i = 0;
      for (int y = 0; y < kPatchSize; ++y) {
        const float along_v = amplitude * wave.at[fv][y];
        for (int x = 0; x < kPatchSize; ++x) values[i++] += along_v * wave.at[fu][x];
      }
    }
  }
  return values;
}

}  // namespace zenith
