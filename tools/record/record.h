#pragma once
// What `zenith record` does: takes frames, CAN frames and poses from a source and writes them as a
// recording that can be read at any moment, whatever happens.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "platform/base/result.h"
#include "platform/base/time.h"
#include "platform/linux/clock_reading.h"
#include "tools/record/source.h"

namespace zenith::tools {

struct RecordPlan {
  std::filesystem::path out;
  double duration_s = 0.0;   // 0: until it is stopped
  double max_size_mb = 0.0;  // 0: as much as the disk has
  double keep_free_mb = 100.0;
  int compression = 1;
  int threads = 2;
  // How long a frame may wait for a place; a daemon's frames wait there meanwhile.
  Duration patience = {1'000'000'000};
  std::function<ClockReading()> clocks = read_clocks;  // written to clock.csv
};

// How far it is.
struct RecordFigures {
  double seconds = 0.0;  // from the first to the last frame's stamp
  std::uint64_t frames = 0;
  std::uint64_t can = 0;
  std::uint64_t poses = 0;
  std::uint64_t bytes = 0;
  double free_mb = 0.0;            // on the disk
  std::uint64_t left_out = 0;      // frames: this computer or its disk was too slow
  std::uint64_t can_left_out = 0;  // the same
  std::uint64_t passed_over = 0;   // frames that the daemon, or the driver, did not see itself
  std::uint64_t out_of_order = 0;  // frames whose stamp does not rise: left out
  bool synchronised = false;       // the wall clock, so that clock.csv can be trusted
  std::string why;                 // it ended
  bool failed = false;             // it ended otherwise than asked
};

// Checks that `plan.out` is free: a recording is never overwritten.
Status check_record_target(const std::filesystem::path& out);

// Until the source ends, a limit is reached, or `stop` says so. `tell` hears how far it is, several
// times a second. An error: nothing could be written at all. What fails later ends the recording,
// stands in `why`, and leaves what was written until then.
Result<RecordFigures> record(const RecordPlan& plan, RecordSource& source,
                             const std::function<bool()>& stop,
                             const std::function<void(const RecordFigures&)>& tell);

// The end, for a person: what is there, what is missing, how to replay it.
std::string record_summary(const RecordPlan& plan, const RecordFigures& figures);

}  // namespace zenith::tools
