#pragma once
// The core: one robot's SLAM with its peers' maps. A pure function of its inputs: no clock, no
// system call, no thread, no heap. The same inputs give the same outputs, bit for bit.
//
// Memory: the caller hands over one block at construction; nothing is allocated afterwards. Views
// that a Slam returns are valid until the next step() or receive().
// Threads: none of its own; one caller at a time.

#include <cstddef>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "platform/base/memory_table.h"
#include "platform/base/time.h"
#include "slam/capacity.h"
#include "slam/counters.h"
#include "slam/filter/dead_reckoning.h"
#include "slam/fleet/alignment.h"
#include "slam/fleet/record.h"
#include "slam/geometry.h"
#include "slam/image/image.h"
#include "slam/parameters.h"
#include "slam/picture.h"
#include "slam/recovery/tracking.h"
#include "slam/robot.h"
#include "slam/watch/measures.h"
#include "slam/watch/verdict.h"
#include "slam/wheels.h"

namespace zenith {

struct StepInput {
  Time stamp;       // the frame's capture stamp
  ImageView frame;  // the fisheye frame, as large as the lens says
  // All since the last step or add_wheels(), in order; the last one at or after `stamp`, or the
  // travel is extrapolated (and counted).
  std::span<const WheelSample> wheels;
  int corners_max = kMaxCorners;  // fewer than Parameters::corners_max sheds load in this frame
};

// All numbers are finite, whatever the input was.
struct StepOutput {
  Time stamp;
  bool accepted = false;  // false: the frame was refused, all else is of the last one
  bool repeated = false;  // the wheels moved, the picture is the last one's: it was not used
  // Beside kTracking the pose is the wheels' since the last frame that was used.
  TrackingState tracking = TrackingState::kTracking;
  Pose2 T_start_robot;  // base_link in the robot's own start frame
  Eigen::Matrix3d pose_covariance = Eigen::Matrix3d::Zero();  // over (x, y, theta)
  double effective_sample_size = 0.0;
  Odometry odometry;  // the wheels alone
  // Standard deviation of the frames' stamps; 0 while they come at equal intervals, or at any.
  double stamp_jitter_s = 0.0;
  double corner_sigma_px = 0.0;  // how noisy corners were found to be, in the fisheye frame
  int corners = 0;
  int candidates = 0;  // landmarks predicted into the image
  int matched = 0;
  int inliers = 0;
};

class Slam {
 public:
  // What the constructor needs, by parts, and how many bytes together. Depends on the parameters
  // (particles) alone.
  static MemoryTable memory_table(const Parameters& parameters);
  static std::size_t memory_needed(const Parameters& parameters) {
    return memory_table(parameters).total();
  }

  // `memory` must outlive the Slam, be aligned to 64 bytes and hold memory_needed() bytes; else the
  // program ends (platform/base/ensure.h). Parameters are taken within_limits().
  Slam(const RobotConfig& robot, const Parameters& parameters, std::uint64_t seed,
       std::span<std::byte> memory);
  ~Slam();
  Slam(const Slam&) = delete;
  Slam& operator=(const Slam&) = delete;

  // One frame. A frame that is not as large as the lens says, has no pixels, or a stamp that does
  // not rise is refused and counted: the output is the last one, with `accepted` false. Stamps of a
  // clock that was set back are taken again after kOtherClockFrames (slam/bounds.h).
  const StepOutput& step(const StepInput& input);

  // Wheel samples ahead of the next frame, for callers that cannot keep them until it comes.
  void add_wheels(std::span<const WheelSample> samples);

  // Of the last step.
  const StepOutput& output() const;
  // What its frame showed. Copies 105 kB.
  void look(Picture& out) const;
  StepCounters counters() const;

  // Whether the set-up can be right, and what of it was measured: slam/watch.
  const SetupVerdict& verdict() const;
  const SetupMeasures& setup_measures() const;

  // Own promoted landmarks, in rising id, into `out`; returns how many were written.
  std::size_t landmarks(std::span<LandmarkEstimate> out) const;

  // Own landmarks that changed since they were last published, as records; returns how many were
  // written. Call again while it fills `out`.
  std::size_t publish(std::span<LandmarkRecord> out);

  // A peer's records; those that are not plausible are refused. `peer` is a slot in
  // [0, kMaxPeers), here and below: calls with another one are counted, and do nothing.
  void receive(int peer, std::span<const LandmarkRecord> records);

  // The robot's own map of an earlier run, as one more peer: `past self`. Found and aligned as any
  // other; since it is whole from the start, after less driving. T_own_peer of its alignment takes
  // the stored map's coordinates into the present ones.
  void remember(int peer, std::span<const LandmarkRecord> records);

  // The peer in this slot is no more: its map and all that was made of it go. The slot may become
  // another peer's.
  void forget(int peer);

  // A peer has merged with this robot; `T_own_peer` is the inverse of what it found. The offer is
  // tested map against map before it counts.
  void offer_alignment(int peer, const Pose2& T_own_peer);

  // The state with each known peer: the leading hypothesis, or none when there is no candidate.
  std::span<const Alignment> alignments() const;

  // The pairs of landmarks that hold the alignment with `peer` (its leading hypothesis).
  std::span<const Correspondence> correspondences(int peer) const;

  // The common map: own landmarks fused with all merged peers', in the own start frame. Returns how
  // many were written.
  std::size_t fused_landmarks(std::span<FusedLandmark> out) const;

 private:
  friend class JointSlam;
  struct State;
  State* state_;  // inside the caller's memory
};

}  // namespace zenith
