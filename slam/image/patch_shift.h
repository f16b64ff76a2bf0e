#pragma once
// Where a look lies in a patch, to a part of a pixel: what a detector's peak cannot say, which
// slides with the view along edges and where two depths meet.
//
// One step of Gauss and Newton on the two patches, from the seen one's centre, with the mean of
// both gradients (Malis, "Improving vision-based control using efficient second-order
// minimization", ICRA 2004), over shift, turn and contrast:
//
//   seen(x) - look(x) = g(x) . (s + turn J x) + contrast look(x) + mean,   of unit norm
//
// weighed by a Gaussian around the centre. Along a straight edge the shift is not known: a prior
// keeps it near zero there.

#include <optional>

#include <Eigen/Core>

#include "slam/image/patch.h"

namespace zenith {

// The place of the look's centre in the seen patch, from its centre, in pixels of the patch. None
// when the two differ by more than a step can tell.
std::optional<Eigen::Vector2f> patch_shift(const Patch& look, const Patch& seen);

}  // namespace zenith
