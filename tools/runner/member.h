#pragma once
// One robot of a run: its source, its Slam in one block of memory, its log.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "platform/base/memory_block.h"
#include "platform/base/result.h"
#include "platform/recording/source.h"
#include "slam/slam.h"
#include "tools/runner/run_log.h"

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
  // The parts of step(), when another steps this robot's Slam: what to give it, and the log of what
  // came out.
  StepInput input() const;
  void log_step(double step_s);

  Slam& slam() { return *slam_; }
  const Slam& slam() const { return *slam_; }
  const std::string& name() const { return log_.name; }
  double frame_period_s() const { return 1.0 / source_.config().frame_rate_hz; }

  // From now on this robot is in one filter with others, whose map is in the start frame of their
  // leader; `peers` are its alignments with them.
  void share_filter(const Pose2& T_leader_start, std::vector<PeerLog> peers);

  // After a step: its log, and the own landmarks in the robot's own start frame.
  const FrameLog& last_frame() const { return log_.frames.back(); }
  std::vector<LandmarkEstimate> landmarks() const;

  // The log, completed with the final map. Call once.
  RobotLog finish();

 private:
  void to_start_frame(LandmarkEstimate& landmark) const;
  void read_maps();

  Source& source_;
  int index_;
  int team_size_;
  MemoryBlock memory_;
  std::optional<Slam> slam_;
  SourceFrame frame_;
  bool has_frame_ = false;
  Pose2 T_start_map_;              // while the filter is shared
  std::vector<PeerLog> partners_;  // robots in the same filter
  RobotLog log_;
};

}  // namespace zenith::tools
