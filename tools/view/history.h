#pragma once
// The last while of live robots, to look back: the lines that they told, with their moments.
// Bounded in bytes; what is dropped at its old end stays as a state, so that the rest begins with
// whole maps and paths.
//
// note() is called by the thread that listens, the others by any.

#include <cstddef>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "platform/base/time.h"
#include "tools/view/kept_lines.h"
#include "tools/view/robot_state.h"
#include "tools/view/timeline.h"

namespace zenith::tools {

class History {
 public:
  // Of text: some twenty minutes of one robot; less of several, and where pictures are looked at.
  static constexpr std::size_t kMostBytes = std::size_t{24} << 20U;

  explicit History(std::size_t most_bytes = kMostBytes) : most_bytes_(most_bytes) {}

  // Robots are numbered in the order in which they are added.
  void add(const std::string& label);
  // A line that robot's state has taken.
  void note(std::size_t robot, const RobotState& state, const TelemetryLine& line,
            std::string_view text, Time now);

  // From the oldest line to the newest one.
  double duration_s() const;
  std::size_t bytes() const;
  // All of it; its moments begin at the oldest line.
  Timeline timeline() const;

 private:
  struct Entry {
    Time at;
    std::size_t robot;
    std::string text;
  };
  void drop_oldest();

  const std::size_t most_bytes_;
  mutable std::mutex mutex_;
  std::vector<RobotState> before_;  // all that was dropped
  std::vector<KeptLines> kept_;
  std::deque<Entry> entries_;
  std::size_t bytes_ = 0;
  std::uint64_t version_ = 0;
};

}  // namespace zenith::tools
