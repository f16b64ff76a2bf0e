#pragma once
// The CAN log of a recording: the frames of one interface, as they were heard.

#include <cstddef>
#include <filesystem>
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
  std::size_t other_frames = 0;  // remote, FD and error frames
  std::size_t malformed = 0;
  std::string first_malformed;  // "path:line"
};

// Malformed lines are counted. More than kMaxLoggedFrames of the interface are an error.
Result<CanLog> parse_can_log(InputLines& lines, const std::string& interface);
Result<CanLog> read_can_log(const std::filesystem::path& path, const std::string& interface);

}  // namespace zenith
