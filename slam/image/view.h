#pragma once
// Which part of the ceiling the rectified image shows: its field of view, given or fitted to the
// lens, and how much of it the lens fills.
//
// Fitted, it shows all of the lens's image, from the rectified image's middle, the vertical, to the
// farthest pixel; but
//   - 112 degrees at most, the field that measured best with lenses that show more;
//   - of which the lens fills at least half: a camera that leans would leave most of it black.
//   Where
//     it cannot fill half of any field, the one of which it fills the largest share.

#include "slam/image/lens_projection.h"
#include "slam/parameters.h"
#include "slam/robot.h"

namespace zenith {

struct View {
  double fov_deg = 0.0;       // of the rectified image, side to side
  double inside_share = 0.0;  // of its pixels that lie in the lens's image
};

inline constexpr double kWidestFitted_deg = 112.0;
inline constexpr double kNarrowestFitted_deg = 10.0;

// Fitted to the lens as above, rounded up to a tenth of a degree.
View fitted_view(const LensProjection& projection, const CameraMount& mount);

// The view that these parameters ask for. Takes some milliseconds.
View view_of(const Parameters& parameters, const RobotConfig& robot);

// The parameters with a fitted field of view as the number that it is for this robot; others as
// they are.
Parameters with_fitted_view(const Parameters& parameters, const RobotConfig& robot);

}  // namespace zenith
