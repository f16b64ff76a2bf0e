#pragma once
// Where in the peer's map is the robot? Hough clustering of circles (paper III-A).
//
// A match says: the robot stands on a circle of radius z_r around the peer's landmark, z_r being
// the horizontal distance at which the landmark is seen. Where many circles meet, the robot may be.
// The patch's direction narrows a circle to an arc; an arc of 180 degrees to each side is the
// paper's circle. The grid wraps around: places a whole grid apart share a cell, and the matches
// around a peak tell them apart.

#include <span>

#include "platform/base/arena.h"
#include "slam/fleet/overlap.h"
#include "slam/geometry.h"

namespace zenith {

struct HoughSettings {
  double arc_deg = 20.0;   // to each side of the direction that the patch tells
  double radius_m = 0.25;  // a circle this near to a peak belongs to it
  double inlier_m = 0.15;  // after the fit
  int min_inliers = 5;
  double peak_distance_m = 0.4;
};

// One possible place of the robot in the peer's map, with the pairs that speak for it.
struct PlaceFix {
  Pose2 T_peer_robot;
  float votes = 0.0F;
  int inliers = 0;
  std::array<std::int16_t, kMaxCorners> peer_slot = {};  // by observed; -1: none
};
inline constexpr int kMaxPeaks = 6;
// Peaks of the grid that are looked at: a strong one brings side lobes, which must not hide a
// rival.
inline constexpr int kPeaksTried = 24;
using PlaceFixes = FixedVector<PlaceFix, kMaxPeaks>;

class HoughSearch {
 public:
  void layout(Arena& arena);

  // The best places, most inliers first. Of matches it takes where the robot sees the one and where
  // the other lies; how they came to be is not asked.
  void find_places(const OverlapMatches& matches, const HoughSettings& settings, PlaceFixes& out);

 private:
  static constexpr int kCells = 512;
  static constexpr double kCell_m = 0.1;

  struct Peak {
    int x = 0;
    int y = 0;
    float votes = 0.0F;
  };
  void vote(const OverlapMatch& match, double arc_rad);
  float& cell(int x, int y) {
    return grid_[static_cast<std::size_t>((y & (kCells - 1)) * kCells + (x & (kCells - 1)))];
  }
  float around(int x, int y);
  using Peaks = FixedVector<Peak, kPeaksTried>;
  void find_peaks(int apart, Peaks& peaks);
  static void note_peak(const Peak& peak, int apart, Peaks& peaks);
  static Peak* weakest(Peaks& peaks);

  std::span<float> grid_;
};

// Among `matches`, those that a robot near `place` (any place a whole number of `period_m` away)
// can explain; then the pose on which most agree. inliers = 0: nothing.
PlaceFix fix_place(const OverlapMatches& matches, const HoughSettings& settings,
                   const Eigen::Vector2d& place, double period_m);

}  // namespace zenith
