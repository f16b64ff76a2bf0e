#pragma once
// 8-bit grey PNG files.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "platform/base/result.h"
#include "platform/linux/unique_fd.h"
#include "slam/image/image.h"

namespace zenith {

// Into `pixels`, width * height bytes. Anything but a whole 8-bit grey image of this size, not
// interlaced, is an error that names the file. Whatever the bytes are, the memory taken is that of
// the file, the pixels and a few megabytes.
Status parse_grey_png(std::string_view png, const std::string& name, int width, int height,
                      std::vector<std::uint8_t>& pixels);
Status read_grey_png(const std::filesystem::path& path, int width, int height,
                     std::vector<std::uint8_t>& pixels);

// A new file; one that is there already is an error. `compression`: 0, none, to 9; a higher level
// takes much longer and saves little.
Status write_grey_png(const std::filesystem::path& path, ImageView image, int compression = 1);
// Into a file that is open for writing, and closed then. `path` names it in messages.
Status write_grey_png(UniqueFd file, const std::filesystem::path& path, ImageView image,
                      int compression = 1);

}  // namespace zenith
