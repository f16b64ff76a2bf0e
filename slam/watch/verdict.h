#pragma once
// Whether the robot's set-up can be right, and if not, why: what the watch (setup_watch.h) says.
//
// Plain data. `good`: vision and wheels were compared often enough, and agree. `doubtful`: not yet
// compared, or the map may be bent. `wrong`: the set-up contradicts itself; the map is not to be
// used before that is mended.

#include <array>
#include <cstdint>
#include <string_view>

#include "platform/base/fixed_text.h"
#include "platform/base/fixed_vector.h"
#include "platform/base/time.h"

namespace zenith {

enum class VerdictState : std::uint8_t { kGood, kDoubtful, kWrong };

// "good", "doubtful", "wrong"
std::string_view verdict_name(VerdictState state);

enum class SetupCode : std::uint8_t {
  kNotJudgedYet,
  kPictureMirrored,
  kYawWrong,
  kWheelsSwapped,
  kLeftReversed,
  kRightReversed,
  kWheelsReversed,
  kWheelsContradict,
  kTurnScale,
  kWheelsUnequal,
  kStampsApart,
  kStampsJitter,
  kLensWrong,
  kFocalWrong,
  kPictureFrozen,
  kFramesRepeated,
  kFramesMissing,
  kLensCovered,
  kNothingToSee,
  kRobotInView,
  kWheelsSlipped,
  kRobotPushed,
  kViewJumped,
  kLost,
};
inline constexpr int kSetupCodes = 24;

// As in summary.json, telemetry and docs/verdict.md: "picture_mirrored".
std::string_view setup_code_name(SetupCode code);

struct Reason {
  SetupCode code = SetupCode::kNotJudgedYet;
  VerdictState severity = VerdictState::kDoubtful;
  double value = 0.0;    // what was found; its unit follows from the code, see reason_text()
  double since_s = 0.0;  // from the first frame on
  // Still observed. What has happened on the way (a slip, a gap) stays a reason for doubt as long
  // as the map that it went into, without being active.
  bool active = true;
};

struct SetupVerdict {
  VerdictState state = VerdictState::kDoubtful;
  FixedVector<Reason, kSetupCodes> reasons;  // the gravest first, then the oldest
};

// Whether this reason is among the verdict's.
bool gives(const SetupVerdict& verdict, SetupCode code);

// What was expected, what was found, what to do: one line.
using ReasonText = FixedText<320>;
ReasonText reason_text(const Reason& reason);

}  // namespace zenith
