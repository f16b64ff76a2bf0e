#pragma once
// The map of a robot that found itself in the map of its past: what it has seen now and what it
// knew before, as one, in the frame of the past one.
//
// As everything that is made of peers, this is made by reading (fusion.h): when the alignment is
// refined or withdrawn, what is made next time is right again.

#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "slam/capacity.h"
#include "slam/fleet/record.h"
#include "slam/geometry.h"

namespace zenith {

// Landmarks that are one are fused; the others go on as they are, with ids of their own. Returns
// how many were written; when `out` (kMaxLandmarks) is full, past ones that were not seen now are
// left out. Both inputs hold no removed records and at most kMaxLandmarks. Some ten milliseconds
// for full maps; not for the realtime thread.
std::size_t continue_map(std::span<const LandmarkRecord> past, std::span<const LandmarkRecord> own,
                         const Pose2& T_past_own, const Eigen::Matrix3d& T_covariance,
                         std::span<LandmarkRecord> out);

}  // namespace zenith
