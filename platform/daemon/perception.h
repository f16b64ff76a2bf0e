#pragma once
// The perception thread: camera and CAN bus in, Slam::step(), pose and map out.
//
//   drain the CAN bus -> wheel samples
//   wait for a frame, kSlice at a time
//   wait for the wheels of its moment, at most odometry.patience_s
//   step; take what peers told; hand over own news; tell how it went
//
// run() takes no memory from the heap, no lock, and writes no log: what others should know goes
// through a snapshot and a queue. A lost device is given to the keeper (turn.h); the loop goes on
// with what remains.

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "platform/base/memory_block.h"
#include "platform/daemon/deadlines.h"
#include "platform/daemon/devices.h"
#include "platform/daemon/exchange.h"
#include "platform/daemon/frame_period.h"
#include "platform/daemon/frozen_picture.h"
#include "platform/daemon/load_shedder.h"
#include "platform/daemon/perception_report.h"
#include "platform/daemon/tap/tap.h"
#include "platform/daemon/turn.h"
#include "platform/linux/snapshot.h"
#include "platform/linux/spsc_queue.h"
#include "platform/linux/triple_buffer.h"
#include "slam/slam.h"

namespace zenith {

// What may change while it runs.
struct LiveSettings {
  Duration patience = {50'000'000};
  LoadLimits load;
};

class Perception {
 public:
  // The longest single wait: how soon it sees a stop, and how long CAN frames may lie.
  static constexpr Duration kSlice = {5'000'000};
  // A camera whose picture is frozen is opened again so often, at most.
  static constexpr Duration kReopenFrozen = {5'000'000'000};

  // Allocates all that it needs. `devices`, `exchange` and `tap` must outlive it; without a tap
  // (null) nobody can record.
  Perception(Devices& devices, const Parameters& parameters, std::uint64_t seed,
             const LiveSettings& live, Exchange& exchange, tap::Tap* tap = nullptr);

  // Before run(): a stored map, as this robot's past self; one that is not whole as any peer's.
  void remember(int slot, bool whole, std::span<const LandmarkRecord> map) {
    if (whole) {
      slam_->remember(slot, map);
    } else {
      slam_->receive(slot, map);
    }
  }

  // The thread's body.
  void run(const std::atomic<bool>& stop);

  // --- for other threads --------------------------------------------------------------------

  // The map in kPastSlot was abandoned: from the next frame on the robot does not look for itself
  // in it.
  void leave_past() { past_left_.store(true, std::memory_order_relaxed); }
  Turn& camera_turn() { return camera_turn_; }
  Turn& can_turn() { return can_turn_; }
  const Deadlines& deadlines() const { return deadlines_; }
  bool read(PerceptionReport& out) const { return reports_.read(out); }
  // Rises as long as the loop turns: what the watchdog asks.
  std::uint64_t heartbeat() const { return heartbeat_.load(std::memory_order_relaxed); }
  // One reader, and one writer, each.
  bool next_event(PerceptionEvent& out) { return events_.pop(out); }
  void set_live(const LiveSettings& live);
  // Somebody looks: the next step leaves what it saw. Else pictures cost the thread one load a
  // frame.
  void ask_picture() { picture_asked_.store(true, std::memory_order_relaxed); }
  // One reader: the picture that came since the last call, or nullptr. Valid until the next call.
  const Picture* next_picture() { return pictures_.fetch() ? &pictures_.front() : nullptr; }

 private:
  void turn_once();
  void take_live();
  void wait_for_frame();
  void wait_for_wheels();
  bool wheels_are_there(Time now) const;
  std::size_t receive_can(Duration timeout);
  void keep(const WheelSample& sample, Time now);
  void note_can_state();
  void lose_camera(const char* why);
  bool pass_over_old_picture();
  void use_frame();
  void receive_peers();
  void publish();
  void leave_picture();
  void note_alignments();
  void note_repairs();
  void note_verdict();
  void note_load(Duration wall);
  void write_report(Time now);
  void tell(PerceptionEventKind kind, const char* text = "", int peer = 0, int value = 0);
  void tell(PerceptionEventKind kind, const Reason& reason);

  Devices& devices_;
  Exchange& exchange_;
  tap::Tap* const tap_;
  WheelDecoder decoder_;
  FrozenPicture frozen_;
  Time next_reopening_;  // for a frozen picture
  FramePeriod period_;
  bool camera_is_known_ = false;  // period_ has begun with the camera as it was opened last
  LiveSettings live_;
  MemoryBlock memory_;
  std::optional<Slam> slam_;
  LoadShedder shedder_;

  std::array<CanFrame, 64> can_frames_;
  FixedVector<WheelSample, kMaxWheelSamples> wheels_;
  std::array<LandmarkRecord, 64> records_;
  std::optional<CameraFrame> frame_;  // waits for its wheels, or its step
  Time received_;                     // frame_
  PageFaults faults_at_start_;
  Time next_report_;
  PerceptionReport report_;

  Turn camera_turn_;
  Turn can_turn_;
  Deadlines deadlines_;
  Snapshot<PerceptionReport> reports_;
  SpscQueue<PerceptionEvent, 64> events_;
  TripleBuffer<LiveSettings> new_live_;
  TripleBuffer<Picture> pictures_;
  std::atomic<bool> picture_asked_ = false;
  std::atomic<bool> past_left_ = false;
  std::atomic<std::uint64_t> heartbeat_ = 0;
};

// Runs the step's code once on a small map that is then forgotten, so that its pages are in memory
// before the first deadline.
void warm_up(const RobotConfig& robot, const Parameters& parameters);

}  // namespace zenith
