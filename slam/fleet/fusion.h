#pragma once
// The common map: own landmarks and merged peers' landmarks as one, made by reading.
//
// A landmark that both have is fused in information form,  P^-1 = P_own^-1 + P'^-1, with
// P' = R P R^T + J P_T J^T: the peer's landmark seen through the alignment (replaces Eq. 8-10). For
// independent observations that equals the stacked update of Eq. 3.

#include <span>

#include "slam/fleet/fleet.h"

namespace zenith {

// A peer's landmark in the own frame.
LandmarkEstimate transform_landmark(const PeerLandmark& landmark, const Pose2& T_own_peer,
                                    const Eigen::Matrix3d& T_covariance);

LandmarkEstimate fuse(const LandmarkEstimate& a, const LandmarkEstimate& b);

// Returns how many were written; a full `out` ends the reading.
std::size_t read_common_map(const Map& map, const Fleet& fleet, std::span<FusedLandmark> out);

}  // namespace zenith
