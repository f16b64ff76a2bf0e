#pragma once
// Which mistake in a robot's set-up explains its drive: a mirrored picture, exchanged or reversed
// wheels, a camera that is turned by a quarter or a half, stamps that are apart.
//
// Every explanation (wheels in each order and sign, picture mirrored or not) is applied to the fit
// of what was seen by what the wheels told (setup_fit.h), at the best delay:
//
//   turn b / 2 = alpha . u,   shift = beta . u,   u = ((l + r) / 2, (r - l) / 2)
//
// It explains the drive when alpha = (0, s), s > 0. What is left of the direction of beta_1 is the
// yaw of the mount. The explanation with the fewest mistakes is taken; others that are as good are
// told beside it: one camera does not tell all of them apart (docs/verdict.md).

#include <string>
#include <utility>
#include <vector>

#include "platform/base/result.h"
#include "slam/watch/verdict.h"
#include "tools/calibrate/drive_data.h"
#include "tools/calibrate/setup_fit.h"

namespace zenith::tools {

enum class Mirrored { kNot, kColumns, kRows };

// What turns a set-up into a right one.
struct SetupChange {
  WheelOrder wheels;
  Mirrored picture = Mirrored::kNot;  // columns run, or rows, the other way round
  double yaw_rad = 0.0;  // to be added to the mount's; 0 while it is no mistake, but a calibration

  bool operator==(const SetupChange&) const = default;
};

struct DriveSetup {
  bool judged = false;  // the drive shows turns and straight ways
  SetupFit fit;
  SetupChange change;
  double delay_s = 0.0;           // the wheels' stamps are late; 0 while that is not sure
  std::vector<SetupCode> causes;  // empty: none is found
  std::vector<SetupChange> alternatives;

  bool contradicts() const;  // nothing explains the drive
};

// The longest delay that is looked for, to both sides.
inline constexpr double kLongestDelay_s = 1.5;

DriveSetup find_setup(const DriveData& data);

// The drive as it would have been recorded with the set-up mended, but for the mount's yaw, which
// the solver starts from anyway. Frames of which the wheels tell nothing are left out.
DriveData mended(const DriveData& data, const DriveSetup& setup);

// A sentence for each cause, and for alternatives.
std::vector<std::string> setup_text(const DriveSetup& setup);

// "left and right wheel are exchanged": what a change mends.
std::string change_text(const SetupChange& change);

}  // namespace zenith::tools
