#pragma once
// The map's store: landmarks, their anchors, their looks. Fixed capacities; full rejects.

#include <algorithm>
#include <cstdint>
#include <span>

#include "platform/base/arena.h"
#include "slam/filter/ancestry.h"
#include "slam/filter/calibration.h"
#include "slam/filter/drift.h"
#include "slam/filter/landmark.h"
#include "slam/geometry.h"
#include "slam/map/landmark_info.h"

namespace zenith {

class Map {
 public:
  void layout(Arena& arena, int particles);
  // After layout over a real block: makes everything free.
  void reset();

  // A new tentative landmark at an anchor; -1 when full.
  int create(int anchor);
  void remove(int slot);

  // Published landmarks that were removed, oldest first; false when all were taken.
  struct Removal {
    std::uint32_t id = 0;
    std::uint32_t revision = 0;  // the one that tells of the removal
  };
  bool take_removal(Removal& out);
  // Removals that found no room: peers were not told.
  std::uint64_t removals_untold() const { return removals_untold_; }

  // The camera rows of this frame as an anchor; -1 when full. An anchor that no landmark holds
  // after release_if_unused() is free again.
  // `drift_travel_m`: the travel whose drift lies between this anchor and the map's start, which is
  // less than all travel where loops were closed.
  int create_anchor(const CameraRows& camera, const PoseSensitivity& by_calibration,
                    double drift_travel_m = 0.0);
  void release_if_unused(int anchor);
  float drift_travel_m(int slot) const {
    return anchor_drift_m_[static_cast<std::size_t>(std::max(info(slot).anchor, 0))];
  }

  // Moves a piece of the map, for each particle by its own transform of the start frame: the
  // anchors that hold a landmark whose travel unseen, and whose drift travel, lie within the
  // piece's. They count as nearer to the start by `shorter_m`, but not nearer than `least_m`.
  // Returns the landmarks that moved: their cached positions are to be refreshed.
  struct Piece {
    double unseen_from_m = 0.0;
    double unseen_to_m = 0.0;
    double drift_from_m = 0.0;
    double drift_to_m = 0.0;
  };
  std::span<const std::int32_t> move_piece(const Piece& piece, std::span<const Pose2> T_new_old,
                                           double turn_rad, double shorter_m);

  // A closing ties the piece to another part of the map: from now on both depend on the calibration
  // in the same way. `by_calibration`: how that of the piece changes, as of a rigid body at `at_m`.
  void tie_piece(const Piece& piece, const PoseSensitivity& by_calibration,
                 const Eigen::Vector2d& at_m);

  // Adds a look; false when the landmark has kMaxAppearances, or when the pool has no more than
  // the first looks of landmarks that may still come.
  // `centre_px`: where the landmark lies in the patch, from its middle.
  bool add_appearance(int slot, const Patch& patch, const CompactPatch& compact,
                      float direction_rad,
                      const Eigen::Vector2f& centre_px = Eigen::Vector2f::Zero());

  // The landmark's rows at today's generation, and for today's calibration.
  LandmarkRows rows(int slot);

  // How landmark and anchor depend on the camera's calibration (see calibration.h), and the
  // calibration that rows() moves them to.
  void set_calibration(const CalibrationVector& beta) { calibration_ = beta; }
  // How noisy corners are (noise_scale.h): rows() widens covariances that were made while the noise
  // was thought smaller.
  void set_noise(float kappa) { kappa_ = kappa; }
  LandmarkSensitivity& by_calibration(int slot) {
    return calibrations_[static_cast<std::size_t>(slot)].B;
  }
  const PoseSensitivity& anchor_by_calibration(int slot) const {
    return anchor_calibrations_[static_cast<std::size_t>(info(slot).anchor)].A;
  }
  // Where a landmark's anchor is, by the first particle.
  Eigen::Vector2d anchor_m(int slot) const;
  // How far an anchor may have drifted (see drift.h); zero when it is created.
  PlacedDrift& anchor_drift(int anchor) { return anchor_drifts_[static_cast<std::size_t>(anchor)]; }
  const PlacedDrift& anchor_drift(int anchor) const {
    return anchor_drifts_[static_cast<std::size_t>(anchor)];
  }
  // The way driven while the map was made: by it landmarks age.
  double way_m() const { return way_m_; }
  void add_way(double way_m) { way_m_ += way_m; }

  // Recomputes the cached place from the rows. False when it is no number or lies beyond
  // slam/bounds.h: the landmark is of no use, and its cached place is as it was.
  bool refresh_place(int slot, const double* weight, double camera_z_m);

  // A resampling happened. Also brings some rows up to date in turn, so that none grows older than
  // the ancestry remembers.
  void resampled(std::span<const std::uint16_t> parents);

  std::span<LandmarkInfo> landmarks() {
    return infos_.first(static_cast<std::size_t>(slots_used_));
  }
  std::span<const LandmarkInfo> landmarks() const {
    return infos_.first(static_cast<std::size_t>(slots_used_));
  }
  LandmarkInfo& info(int slot) { return infos_[static_cast<std::size_t>(slot)]; }
  const LandmarkInfo& info(int slot) const { return infos_[static_cast<std::size_t>(slot)]; }
  const Appearance& appearance(int i) const { return pool_[static_cast<std::size_t>(i)]; }
  int size() const { return size_; }
  int anchors_used() const { return anchors_used_; }
  std::uint32_t next_id() const { return next_id_; }

  // The best NCC of a patch over the landmark's looks; only looks whose direction agrees within
  // `max_turn_rad` count. `direction_rad` is the patch's, in the start frame.
  struct Look {
    const Appearance* appearance = nullptr;  // none: no look in that direction
    float ncc = -1.0F;
  };
  Look best_look(int slot, const Patch& patch, float direction_rad, float max_turn_rad) const;
  float best_ncc(int slot, const Patch& patch, float direction_rad, float max_turn_rad) const {
    return best_look(slot, patch, direction_rad, max_turn_rad).ncc;
  }

 private:
  int particles_ = 0;
  int size_ = 0;
  int slots_used_ = 0;  // all used slots lie below
  int anchors_used_ = 0;
  std::uint32_t next_id_ = 1;
  int free_appearance_ = -1;
  int appearances_free_ = 0;
  int sweep_landmark_ = 0;
  int sweep_anchor_ = 0;
  double way_m_ = 0.0;

  Ancestry ancestry_;
  LandmarkRowStore rows_;
  AnchorRowStore anchor_rows_;
  std::span<LandmarkInfo> infos_;
  std::span<std::int32_t> free_slots_;  // a stack; the lowest slot on top at start
  std::span<std::int32_t> anchor_users_;
  std::span<float> anchor_drift_m_;
  std::span<std::int32_t> moved_;  // landmarks, of move_recent()
  std::span<std::int32_t> free_anchors_;
  std::span<Appearance> pool_;
  std::span<Removal> removals_;  // a ring
  std::size_t removal_first_ = 0;
  std::size_t removal_count_ = 0;
  std::uint64_t removals_untold_ = 0;

  struct LandmarkCalibration {
    LandmarkSensitivity B = LandmarkSensitivity::Zero();
    CalibrationVector beta = CalibrationVector::Zero();  // for which the rows are right
  };
  struct AnchorCalibration {
    PoseSensitivity A = PoseSensitivity::Zero();
    CalibrationVector beta = CalibrationVector::Zero();
  };
  using AnchorFlags = std::array<bool, kMaxAnchors>;
  AnchorFlags anchors_of(const Piece& piece) const;
  void follow_calibration(int slot, int anchor);
  void follow_calibration(int anchor);
  void follow_noise(int slot);
  float kappa_ = 1.0F;
  void move_anchor(int anchor, std::span<const Pose2> T_new_old);
  CalibrationVector calibration_ = CalibrationVector::Zero();
  std::span<LandmarkCalibration> calibrations_;
  std::span<AnchorCalibration> anchor_calibrations_;
  std::span<PlacedDrift> anchor_drifts_;
};

}  // namespace zenith
