#pragma once
// The landmarks of another map come into this one, when two filters become one: common ones are
// fused, the others taken over with their anchors and looks.
//
// A landmark's state is relative to its anchor, so moving a map is moving its anchors.

#include <span>

#include "platform/base/arena.h"
#include "slam/geometry.h"
#include "slam/map/map.h"

namespace zenith {

struct SlotPair {
  std::int32_t own = -1;
  std::int32_t other = -1;
};

struct ImportSettings {
  double pair_m = 0.30;  // a pair that lies farther apart is none
  float ncc_new_appearance = 0.85F;
};

struct ImportCounters {
  std::uint64_t fused = 0;
  std::uint64_t imported = 0;
  std::uint64_t rejected_full = 0;  // no room for the landmark or its anchor
};

class MapImport {
 public:
  void layout(Arena& arena, int particles);

  // The pairs of landmarks that are one: the given ones that hold, and further ones
  // (same_landmark.h). Each landmark is in one pair at most. Valid until the next call.
  std::span<const SlotPair> find_pairs(const Map& own, const Map& other, const Pose2& T_own_other,
                                       std::span<const SlotPair> known,
                                       const ImportSettings& settings);

  // Particle i of `other` becomes one with particle i of `own`, moved by T_own_other[i]; the places
  // are refreshed with `weight`. `T_mean` turns the directions of the looks.
  ImportCounters run(Map& own, Map& other, std::span<const Pose2> T_own_other, const Pose2& T_mean,
                     std::span<const SlotPair> pairs, std::span<const double> weight,
                     double camera_z_m, const ImportSettings& settings);

 private:
  int find_twin(const Map& own, const Map& other, int slot, const Pose2& T_own_other) const;
  bool take_over(Map& own, Map& other, int slot, std::span<const Pose2> T_own_other,
                 const Pose2& T_mean);
  int take_over_anchor(Map& own, const LandmarkRows& rows, std::span<const Pose2> T_own_other);

  std::span<SlotPair> pairs_;          // kMaxLandmarks
  std::span<std::int32_t> own_of_;     // by other's slot: the partner, or -1
  std::span<std::int32_t> other_of_;   // by own slot
  std::span<std::int32_t> anchor_of_;  // by other's anchor: the own one, or -1
  CameraRows scratch_;
};

}  // namespace zenith
