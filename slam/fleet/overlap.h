#pragma once
// Search of common landmarks in a peer's map from one frame (paper III-A): similar looks, similar
// heights.

#include <span>

#include <Eigen/Core>

#include "platform/base/fixed_vector.h"
#include "slam/capacity.h"
#include "slam/fleet/peer_map.h"

namespace zenith {

// An own landmark seen in this frame.
struct Observed {
  int slot = -1;
  std::uint32_t id = 0;
  Eigen::Vector2d from_robot_m = Eigen::Vector2d::Zero();  // base_link, by this frame alone
  double z_m = 0.0;
  double z_sigma_m = 0.0;
  float orientation_rad = 0.0F;  // of the patch, robot axes
  CompactPatch compact;
};
using ObservedFrame = FixedVector<Observed, kMaxCorners>;

// A peer's landmark that may be an observed one. The two directions of the patch tell the robot's
// heading in the peer's frame.
struct OverlapMatch {
  int observed = -1;
  int peer_slot = -1;
  float ncc = 0.0F;
  float heading_rad = 0.0F;
  float weight = 0.0F;  // a look that fits many landmarks says little about the place
  Eigen::Vector2d from_robot_m = Eigen::Vector2d::Zero();  // the observed one, base_link
  Eigen::Vector2d landmark_m = Eigen::Vector2d::Zero();    // in the peer's frame
};
inline constexpr int kMatchesPerObserved = 12;
using OverlapMatches = FixedVector<OverlapMatch, kMaxCorners * kMatchesPerObserved>;

// The best matches of one observed landmark, on the way through a map.
class BestMatches {
 public:
  struct Similar {
    int slot = -1;
    float ncc = 0.0F;
    double turn_rad = 0.0;  // from the observed patch to the landmark's: a heading, not wrapped
  };

  void clear();
  // A landmark that looks like it. Asked often: only what is kept costs more.
  void meet(const Similar& similar);
  // Those that were kept, with their weights and no places.
  void append_to(int observed, OverlapMatches& out) const;

 private:
  FixedVector<Similar, kMatchesPerObserved> best_;
  std::size_t worst_ = 0;
  int similar_ = 0;
};

struct OverlapSettings {
  float ncc_min = 0.75F;
  double height_tolerance_m = 0.15;  // besides three sigmas of both
};

// The best landmarks of the peer for every observed one.
void find_overlap(const ObservedFrame& frame, const PeerMap& peer, const OverlapSettings& settings,
                  OverlapMatches& out);

// Whether two heights may be the same landmark's.
bool heights_agree(const Observed& own, const PeerLandmark& peer, double tolerance_m);

}  // namespace zenith
