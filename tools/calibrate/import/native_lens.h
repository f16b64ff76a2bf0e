#pragma once
// What becomes of a foreign lens: the size of its images settled, its numbers scaled where a person
// asks for it, and checked as the configuration checks them.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "platform/base/result.h"
#include "slam/image/lens.h"
#include "tools/calibrate/import/foreign_lens.h"

namespace zenith::tools {

// What a person says about it on the command line.
struct SizeWish {
  std::optional<std::pair<int, int>> size;  // of the robot's images: width, height
  // Of the file's pixels to the robot's: 0.5 when the robot's images are half as wide. 1 also says
  // that an optical axis far from the middle is meant.
  std::optional<double> scale;
};

struct NativeLens {
  Lens lens;
  std::vector<std::string> notes;
};

// The error says why this lens is none, and what to do.
Result<NativeLens> native_lens(const ForeignLens& foreign, const SizeWish& wish);

// As of a stream with `scale` times as many pixels along each side: pixel centres are whole
// numbers, so cu' = (cu + 0.5) scale - 0.5. The size is left alone.
Lens scaled(const Lens& lens, double scale);

// How much of the world an image shows, in degrees; across the optical axis, from one edge's middle
// to the other, and from corner to corner. None where the lens has no ray for it.
struct AngleOfView {
  std::optional<double> horizontal_deg;
  std::optional<double> vertical_deg;
  std::optional<double> diagonal_deg;
};
AngleOfView angle_of_view(const Lens& lens);

}  // namespace zenith::tools
