#pragma once
// Several robots in one filter (paper II-B, Eq. 2-3): a joint particle is a pose of every robot and
// one map, with one weight and one ancestry.
//
//   p(r^1, ..., r^k, m | z, u) = p(m | r^1, z^1, ..., r^k, z^k) prod_j p(r^j | ...)
//
// Robots begin alone, each with the filter of its Mapper. join() makes two filters one: both are
// resampled to equal weights, particle i of the one is put together with particle i of the other
// (they are independent, so any pairing is a fair one) at a transform T_i that is drawn from the
// Gaussian of the alignment given both particles' own maps, and the maps become one: a landmark
// that both hold is fused, the others move by moving their anchors. From then on every landmark is
// updated once in a time step, with the stacked residual of all robots that see it.
//
// In a joint filter the camera's calibration is no longer learned: every robot goes on correcting
// with what it has learned by then. All cameras must be at the same height, for a landmark's state
// is the inverse of its height above the camera.
//
// Threads: one caller. Memory: laid out once; the Mappers are the caller's and must outlive this.

#include <array>
#include <cstdint>
#include <span>

#include "slam/filter/landmark_stacked.h"
#include "slam/fleet/align.h"
#include "slam/map/map_import.h"
#include "slam/mapper.h"

namespace zenith {

struct JointCounters {
  std::uint64_t joins = 0;
  std::uint64_t joins_refused = 0;
  std::uint64_t common_landmarks = 0;    // fused when filters were joined
  std::uint64_t imported_landmarks = 0;  // taken over as they were
  std::uint64_t rejected_full = 0;
  // updates[k]: landmark updates with the observations of k robots.
  std::array<std::uint64_t, kMaxObservers + 1> updates = {};
};

// One robot's used frame.
struct JointFrame {
  int robot = -1;
  MotionIncrement moved;         // by the wheels since its last used frame
  Features* features = nullptr;  // corrected in place
  const FeatureExtractor* view = nullptr;
};

class JointFilter {
 public:
  void layout(Arena& arena, const Parameters& parameters);
  void build(const Parameters& parameters);

  // Robots are numbered as they are added, at most kMaxObservers of them.
  void add(Mapper& mapper);

  // Robots with the same leader are in one filter; a robot alone leads itself.
  int leader(int robot) const { return members_[static_cast<std::size_t>(robot)].leader; }
  int size_of_group(int leader) const;
  // From the robot's own start frame to the frame of its filter, which is its leader's start frame.
  const Pose2& T_leader_start(int robot) const {
    return members_[static_cast<std::size_t>(robot)].T_leader_start;
  }

  // Joins the guest's filter into the host's; both are leaders. `T` takes the guest's coordinates
  // into the host's, `pairs` are common landmarks (own: the host's slots). False when the cameras'
  // heights differ or fewer than three pairs hold.
  bool join(int host, int guest, const Pose2& T_host_guest, std::span<const SlotPair> pairs);

  // One time step: used frames of robots that have the same leader, each robot's at most once.
  void update(std::span<const JointFrame> frames);

  const JointCounters& counters() const { return counters_; }

 private:
  struct Member {
    Mapper* mapper = nullptr;
    int leader = -1;
    Pose2 T_leader_start;
  };
  // A landmark matched in a frame of this time step.
  struct Sighting {
    std::int32_t slot;
    std::int32_t frame;
    const Candidate* candidate;
  };

  Mapper& mapper(int robot) { return *members_[static_cast<std::size_t>(robot)].mapper; }
  std::span<Member> members() {
    return std::span(members_).first(static_cast<std::size_t>(count_));
  }
  void equalise(int leader);
  void draw_transforms(Mapper& host, Mapper& guest, const Pose2& T,
                       std::span<const SlotPair> pairs);
  void gather(std::span<const JointFrame> frames);
  void update_landmarks(std::span<const JointFrame> frames, Mapper& host);
  void start_landmarks(std::span<const JointFrame> frames);

  ImportSettings import_settings_;
  bool weigh_common_ = true;  // see landmark_stacked.h
  std::array<Member, kMaxObservers> members_ = {};
  int count_ = 0;
  std::uint64_t steps_ = 0;
  MapImport import_;
  std::span<Pose2> transforms_;    // by particle
  std::span<PointPair> points_;    // kMaxCorrespondences
  std::span<Sighting> sightings_;  // kMaxObservers * kMaxCorners
  std::size_t sighting_count_ = 0;
  JointCounters counters_;
};

}  // namespace zenith
