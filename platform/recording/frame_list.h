#pragma once
// data.csv of a camera: the frames' stamps and files.

#include <filesystem>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/base/time.h"

namespace zenith {

struct ListedFrame {
  Time stamp;
  std::string filename;  // inside the folder `data` beside the list
  int line = 0;
};

// Stamps rise strictly; there is at least one frame. Whether the files exist is not looked at.
Result<std::vector<ListedFrame>> read_frame_list(const std::filesystem::path& path);

}  // namespace zenith
