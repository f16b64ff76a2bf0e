#pragma once
// The CAN log of a recording: the frames of one interface, as they were heard.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "drivers/odometry/can_frame.h"
#include "platform/base/result.h"

namespace zenith {

struct CanLog {
  std::vector<CanFrame> frames;  // in the order of the file
  std::size_t other_interfaces = 0;
  std::size_t other_frames = 0;  // remote, FD and error frames
  std::size_t malformed = 0;
  std::string first_malformed;  // "path:line"
};

// Malformed lines are counted.
Result<CanLog> read_can_log(const std::filesystem::path& path, const std::string& interface);

}  // namespace zenith
