#pragma once
// One robot's data in order: what a camera and a CAN bus would have delivered. A recording and a
// simulated drive are both sources.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/base/time.h"
#include "slam/geometry.h"
#include "slam/robot.h"
#include "slam/wheels.h"

namespace zenith {

struct SourceFrame {
  Time stamp;
  std::vector<std::uint8_t> pixels;  // as large as the lens says, rows without gaps
  std::vector<WheelSample> wheels;   // since the last frame, up to the first at or after `stamp`
  std::optional<Pose2> truth;        // T_world_robot at `stamp`, where it is known
};

class Source {
 public:
  Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  virtual ~Source() = default;

  virtual const std::string& name() const = 0;
  virtual const RobotConfig& config() const = 0;
  virtual int frame_count() const = 0;

  // Fills `frame` with the next one; false at the end. Stamps rise strictly.
  virtual Result<bool> next(SourceFrame& frame) = 0;
};

}  // namespace zenith
