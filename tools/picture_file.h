#pragma once
// Pictures that people hand in: PNG, JPEG, BMP, PGM and PPM, up to kMaxPicture_px pixels. What is
// larger is refused by its header, before a decoder takes memory for it.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include <opencv2/core.hpp>

#include "platform/base/result.h"

namespace zenith::tools {

inline constexpr std::uint64_t kMaxPictureBytes = std::uint64_t{128} << 20U;
inline constexpr std::uint64_t kMaxPicture_px = 100'000'000;

// Width and height, as the header says; nothing when it is none of these formats.
std::optional<std::pair<std::uint64_t, std::uint64_t>> picture_size(std::string_view bytes);

// Whether it is a regular file that begins as one of these formats does.
bool is_picture(const std::filesystem::path& path);

// In shades of grey. The error says what was expected and found, without the path.
Result<cv::Mat> read_grey_picture(const std::filesystem::path& path);

}  // namespace zenith::tools
