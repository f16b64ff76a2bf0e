#pragma once
// The wheels of a recording, whichever file they come from (odometry_file.h), and what was odd
// about it.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/odometry/wheel_decoder.h"
#include "platform/base/result.h"
#include "platform/recording/can_log.h"
#include "platform/recording/frame_list.h"
#include "slam/wheels.h"

namespace zenith {

struct WheelLog {
  std::vector<WheelSample> samples;  // stamps rise strictly
  WheelDecoderCounters decoder;
  std::size_t malformed = 0;
  std::string first_malformed;  // "path:line: what was expected"
  WheelFault fault;
  // Of CAN logs.
  bool is_can = false;
  CanIds expected_ids;                       // those of the codec
  std::map<CanId, std::size_t> unknown_ids;  // and how often each came
  std::size_t further_unknown = 0;           // frames of ids that found no room there
  CanLog can;                                // without its frames: those were decoded
};

// From a CAN log. `decoder` is that of the robot's base, `start` as parse_can_log() takes it.
// Malformed lines are counted. As check_log(), an error when there is no odometry in it.
Result<WheelLog> read_wheel_log(const std::filesystem::path& path, const std::string& interface,
                                WheelDecoder decoder, std::optional<Time> start = std::nullopt);

// The log, or the error that it holds no odometry, or numbers that cannot be wheels; then with all
// that is odd about it.
Result<WheelLog> check_log(WheelLog log, const std::filesystem::path& path);

// One line for each kind of trouble in the log.
std::vector<std::string> describe_log(const WheelLog& log, const std::filesystem::path& path);

// Holes longer than `max_gap_s` in which frames were taken, and frames outside of the log, one line
// for each kind. An error when the log and the frames have no time in common.
Result<std::vector<std::string>> describe_gaps(const WheelLog& log,
                                               const std::vector<ListedFrame>& frames,
                                               const std::filesystem::path& path, double max_gap_s);

}  // namespace zenith
