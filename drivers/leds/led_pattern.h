#pragma once
// What the robot's lights show: a rhythm for each state, read from one LED alone, whatever its
// colour. docs/lights.md has the table for the robot's users.

#include <cstdint>

#include "platform/base/time.h"

namespace zenith {

enum class RobotLight : std::uint8_t {
  kStarting,  // waits for camera, wheels, calibration
  kMapping,   // maps, alone so far
  kMerged,    // maps, and holds a peer's map as one with its own
  kDegraded,  // maps, but something is missing: a frame rate, a device, time
  kFault,     // does not map, and somebody has to come
  kStopped,   // ended as asked
};

// Bits: which LEDs are lit.
using LedMask = std::uint8_t;
inline constexpr LedMask kStatusLed = 1;  // every state's rhythm; alone it says all
inline constexpr LedMask kPeerLed = 2;    // repeats the rhythm while the maps are merged
inline constexpr LedMask kFaultLed = 4;   // repeats the rhythm while degraded or in fault
inline constexpr int kLedCount = 3;

// The rhythm is kept in steps: call once each, or more often.
inline constexpr Duration kLedStep = {100'000'000};

// Which LEDs are lit when the state has held for so long. A pure function.
LedMask led_pattern(RobotLight light, Duration since_change);

}  // namespace zenith
