#pragma once
// What a Slam holds, and the step in two halves: before and after the filter. One robot's filter
// stands between them in slam.cpp, several robots' in joint_slam.cpp.

#include "slam/bounds.h"
#include "slam/filter/frame_clock.h"
#include "slam/fleet/fleet.h"
#include "slam/mapper.h"
#include "slam/observed.h"
#include "slam/slam.h"
#include "slam/watch/setup_watch.h"

namespace zenith {

struct Slam::State {
  FeatureExtractor extractor;
  Mapper mapper;
  Fleet fleet;
  ObservedFrame observed;
  WheelMotion wheels;
  FrameClock clock;
  StampGuard stamps{kOtherClockFrames};
  DeadReckoning dead_reckoning;
  SetupWatch watch;
  bool used_last = false;  // the last frame
  StepCounters counters;
  StepOutput output;

  // This frame: its corners, and the motion by the wheels since the last used one, without and with
  // the noise's floor.
  Features* features = nullptr;
  MotionIncrement unused;
  MotionIncrement moved;

  void layout(Arena& arena, const Parameters& parameters) {
    extractor.layout(arena);
    mapper.layout(arena, parameters);
    fleet.layout(arena);
  }

  void add_wheels(std::span<const WheelSample> samples);
  // Takes the wheels; false when the frame is refused.
  bool accept(const StepInput& input);
  // Corners; whether the robot moved enough for the frame to be used.
  bool begin(const StepInput& input);
  // Whether there is such a peer.
  bool knows(int peer);

  // After the filter: the pose, and what was matched. T_own_map is from the map's frame to the
  // robot's own start frame.
  void finish(bool used_frame, const Pose2& T_own_map);

  // The search in peers' maps.
  void cooperate(bool used_frame);
};

}  // namespace zenith
