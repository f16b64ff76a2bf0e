#pragma once
// A drive held in memory, so that it can be changed and played again and again. Copies share their
// pixels.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/recording/source.h"

namespace zenith::tools {

using Pixels = std::vector<std::uint8_t>;

struct TapeFrame {
  Time stamp;
  std::shared_ptr<const Pixels> pixels;
  std::optional<Pose2> truth;  // T_world_robot
};

struct Tape {
  std::string name;
  RobotConfig config;
  std::vector<TapeFrame> frames;    // stamps rise
  std::vector<WheelSample> wheels;  // likewise

  Time start() const { return frames.empty() ? Time{} : frames.front().stamp; }
  double duration_s() const {
    return frames.empty() ? 0.0 : (frames.back().stamp - frames.front().stamp).seconds();
  }
};

// All of the source.
Result<Tape> read_tape(Source& source);

// Plays a tape, which must outlive it.
class TapeSource : public Source {
 public:
  explicit TapeSource(const Tape& tape) : tape_(tape) {}

  const std::string& name() const override { return tape_.name; }
  const RobotConfig& config() const override { return tape_.config; }
  int frame_count() const override { return static_cast<int>(tape_.frames.size()); }
  Result<bool> next(SourceFrame& frame) override;

 private:
  const Tape& tape_;
  std::size_t frame_ = 0;
  std::size_t wheel_ = 0;
};

}  // namespace zenith::tools
