#pragma once
// What the perception thread tells the others: a snapshot of its state, and events worth a line in
// the log. Plain data.

#include <array>
#include <cstdint>

#include "drivers/camera/camera.h"
#include "drivers/odometry/can_bus.h"
#include "drivers/odometry/wheel_decoder.h"
#include "platform/base/fixed_vector.h"
#include "platform/base/time.h"
#include "platform/linux/realtime.h"
#include "slam/capacity.h"
#include "slam/counters.h"
#include "slam/fleet/alignment.h"
#include "slam/geometry.h"
#include "slam/slam.h"

namespace zenith {

// The robot's own stored maps lie in the last slots, the one that it goes on with in the very last
// (map_shelf.h); peers' maps in the slots below.
inline constexpr int kPastMaps = 5;
inline constexpr int kPastSlot = kMaxPeers - 1;
inline constexpr int kPeerSlots = kMaxPeers - kPastMaps;

struct PeerReport {
  int peer = 0;
  AlignmentState state = AlignmentState::kCandidate;
  Pose2 T_own_peer;
  std::array<double, 3> variance = {};  // of x, y, theta
  double confidence = 0.0;
  int correspondences = 0;
};

struct PerceptionReport {
  Time written;
  // Of the last frame.
  bool has_pose = false;
  Time stamp;
  Pose2 T_start_robot;
  std::array<double, 6> covariance = {};  // xx xy xt yy yt tt
  // By the wheels alone, as StepOutput's.
  Pose2 T_odom_robot;
  std::array<double, 6> odometry_covariance = {};  // xx xy xt yy yt tt
  std::array<double, 3> velocity = {};             // forward, left, turn
  std::array<double, 6> velocity_covariance = {};
  double effective_sample_size = 0.0;
  TrackingState tracking = TrackingState::kTracking;
  int corners = 0;
  int candidates = 0;
  int matched = 0;
  int inliers = 0;
  Duration step = {0};             // what it took
  Duration period = {0};           // what it may take: FramePeriod's
  Duration agreed_period = {0};    // with the camera; 0: not known
  Duration measured_period = {0};  // likewise
  FixedVector<PeerReport, kMaxPeers> peers;

  bool camera_up = false;
  bool can_up = false;
  bool bus_off = false;
  bool camera_frozen = false;  // the same picture again and again while the robot moves
  Time last_frame;             // received, and not of a frozen picture
  Time last_wheels;            // a sample of the wheels was decoded
  CameraCounters camera;
  CanCounters can;
  WheelDecoderCounters wheels;
  WheelFault wheel_fault;
  StepCounters steps;

  int corners_max = 0;  // the limit in force
  bool sheds = false;
  std::uint64_t frames_shed = 0;
  std::uint64_t frames_unfit = 0;   // not as large as the lens says: not used
  std::uint64_t frames_frozen = 0;  // old pictures under new stamps: not used
  std::uint64_t wheels_late = 0;    // frames that did not get the wheels of their moment
  SetupVerdict verdict;             // on camera, wheels and their clocks
  bool repaired = false;            // the filter had to repair its numbers
  Time last_repair;                 // if so
  PageFaults faults;                // of the thread since the loop began
};

// Takes over what a step told of its frame.
void note_step(PerceptionReport& report, const StepOutput& output);

enum class PerceptionEventKind : std::uint8_t {
  kFirstPose,
  kCameraLost,  // `text`: why
  kPictureFrozen,
  kPictureMoves,  // again
  kCanLost,
  kBusOff,
  kBusBack,
  kMerged,     // with `peer`
  kWithdrawn,  // from `peer`
  kShedding,   // `value` corners from now on
  kShedNoMore,
  kReasonGiven,      // `reason`: of the verdict on the set-up
  kReasonWithdrawn,  // likewise
  kRepaired,  // numbers of the filter: `text` names the kind, `value` repairs since the start
};

struct PerceptionEvent {
  PerceptionEventKind kind = PerceptionEventKind::kFirstPose;
  const char* text = "";  // static
  int peer = 0;
  int value = 0;
  Time at;
  Pose2 pose;
  Reason reason;
};

}  // namespace zenith
