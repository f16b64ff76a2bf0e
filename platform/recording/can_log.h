#pragma once
// The CAN log of a recording: the frames of one interface, as they were heard, in any form of
// candump (candump.h).

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "drivers/odometry/can_frame.h"
#include "platform/base/result.h"
#include "platform/linux/input_file.h"

namespace zenith {

inline constexpr std::size_t kMaxLoggedFrames = 20'000'000;  // five hours, 1000 a second

struct CanLog {
  std::vector<CanFrame> frames;  // in the order of the file
  std::size_t other_interfaces = 0;
  std::size_t other_frames = 0;  // remote and error frames
  std::size_t fd_frames = 0;
  std::size_t drop_reports = 0;  // lines in which candump says that it lost frames
  std::size_t malformed = 0;
  std::string first_malformed;  // "path:line"
  std::string malformed_text;   // the start of that line
  bool local_dates = false;     // -tA: stamps of a clock on the wall, taken as UTC
};

// Malformed lines are counted. More than kMaxLoggedFrames of the interface are an error. Lines that
// name no interface are taken for its own.
//
// `start` is when the log's first line came, on the clock of the recording; without it the stamps
// must be that clock's already. Stamps that count from the first frame or the one before (-tz, -td)
// are an error without it, and no stamps at all always are.
Result<CanLog> parse_can_log(InputLines& lines, const std::string& interface,
                             std::optional<Time> start = std::nullopt);
Result<CanLog> read_can_log(const std::filesystem::path& path, const std::string& interface,
                            std::optional<Time> start = std::nullopt);

}  // namespace zenith
