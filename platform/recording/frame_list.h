#pragma once
// data.csv of a camera: the frames' stamps and files.

#include <filesystem>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/base/time.h"
#include "platform/linux/input_file.h"

namespace zenith {

inline constexpr std::size_t kMaxListedFrames = 1'000'000;  // nine hours, 30 a second

struct ListedFrame {
  Time stamp;
  std::string filename;  // inside the folder `data` beside the list
  int line = 0;
};

// Stamps rise strictly; there are 1 to kMaxListedFrames frames. Whether the files exist is not
// looked at.
Result<std::vector<ListedFrame>> parse_frame_list(InputLines& lines);
Result<std::vector<ListedFrame>> read_frame_list(const std::filesystem::path& path);

}  // namespace zenith
