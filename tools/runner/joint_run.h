#pragma once
// A run in which robots go on in one filter once they are aligned (paper II-B, Eq. 2-3; see
// slam/joint.h). Until then they tell each other their maps, as in every run.
//
// A time step takes the oldest next frame and those of other robots within half a frame period of
// it. When a robot merges with another one, the other's filter joins its own at once, and for good:
// there is no way back from one filter to two.

#include "platform/base/result.h"
#include "tools/runner/run_log.h"
#include "tools/runner/team.h"
#include "tools/runner/team_run.h"

namespace zenith::tools {

// Every member has its first frame. `total` frames for the progress.
Result<JointLog> run_joint(Team& team, const RunOptions& options, int total,
                           const RunProgress& progress);

}  // namespace zenith::tools
