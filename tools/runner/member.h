#pragma once
// One robot of a run: its source, its Slam in one block of memory, its log.

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <optional>
#include <span>

#include "platform/base/result.h"
#include "slam/slam.h"
#include "tools/runner/dead_reckoning.h"
#include "tools/runner/run_log.h"
#include "tools/runner/source.h"

namespace zenith::tools {

class Member {
 public:
  Member(Source& source, const Parameters& parameters, std::uint64_t seed, int index,
         int team_size);

  // Loads the next frame; false at the end of the source.
  Result<bool> advance();
  bool has_frame() const { return has_frame_; }
  Time stamp() const { return frame_.stamp; }

  void step();
  Slam& slam() { return *slam_; }

  // The log, completed with the final map. Call once.
  RobotLog finish();

 private:
  struct Free {
    void operator()(std::byte* block) const { std::free(block); }
  };

  void log_step(const StepOutput& output, double step_s);

  Source& source_;
  int index_;
  int team_size_;
  std::size_t memory_bytes_;
  std::unique_ptr<std::byte, Free> memory_;
  std::optional<Slam> slam_;
  SourceFrame frame_;
  bool has_frame_ = false;
  DeadReckoning odometry_;
  RobotLog log_;
};

}  // namespace zenith::tools
