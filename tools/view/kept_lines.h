#pragma once
// Which lines of a robot's telemetry are kept to be shown later: all, but for pictures, which are
// compressed first and are fewer.

#include <cstdint>
#include <string>
#include <string_view>

#include "platform/base/time.h"
#include "tools/view/robot_state.h"

namespace zenith::tools {

class KeptLines {
 public:
  explicit KeptLines(Duration picture_every) : picture_every_(picture_every) {}

  // What is kept of `line`, whose text is `text` and which `state` has taken: the text, the whole
  // picture that it completes, or nothing ("").
  std::string take(const RobotState& state, const TelemetryLine& line, std::string_view text,
                   Time now);

 private:
  Duration picture_every_;
  std::uint64_t picture_ = 0;  // the serial of the last one kept
  Time next_picture_ = {};
};

}  // namespace zenith::tools
