#include "drivers/leds/led_pattern.h"

#include <algorithm>
#include <string_view>

namespace zenith {
namespace {

// One character is one step; the rhythm repeats. Flashes are counted (1, 2, 3), even blinking is
// slow or fast; no state is shown by steady light, which a program that hangs would show as well.
struct Pattern {
  std::string_view rhythm;
  LedMask leds;
};

constexpr Pattern kStarting = {"##########..........", kStatusLed};
constexpr Pattern kMapping = {"#...................", kStatusLed};
constexpr Pattern kMerged = {"#..#................", kStatusLed | kPeerLed};
constexpr Pattern kDegraded = {"#..#..#.............", kStatusLed | kFaultLed};
constexpr Pattern kFault = {"#.", kStatusLed | kFaultLed};
constexpr Pattern kStopped = {".", 0};

constexpr const Pattern& pattern_of(RobotLight light) {
  switch (light) {
    case RobotLight::kStarting:
      return kStarting;
    case RobotLight::kMapping:
      return kMapping;
    case RobotLight::kMerged:
      return kMerged;
    case RobotLight::kDegraded:
      return kDegraded;
    case RobotLight::kFault:
      return kFault;
    case RobotLight::kStopped:
      break;
  }
  return kStopped;
}

}  // namespace

LedMask led_pattern(RobotLight light, Duration since_change) {
  const Pattern& pattern = pattern_of(light);
  const std::int64_t step = std::max<std::int64_t>(since_change.ns, 0) / kLedStep.ns;
  const auto place = static_cast<std::size_t>(step) % pattern.rhythm.size();
  return pattern.rhythm[place] == '#' ? pattern.leds : LedMask{0};
}

}  // namespace zenith
