#include "tools/picture_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>

#include <opencv2/imgcodecs.hpp>

#include "platform/linux/input_file.h"

namespace zenith::tools {
namespace {

using Size = std::optional<std::pair<std::uint64_t, std::uint64_t>>;

constexpr std::string_view kPng = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpeg = "\xff\xd8\xff";

// 0 beyond the end.
std::uint64_t byte_at(std::string_view bytes, std::size_t at) {
  return at < bytes.size() ? static_cast<unsigned char>(bytes[at]) : 0;
}

std::uint64_t big_endian(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8U | byte_at(bytes, at + i);
  return value;
}

// BMP's sizes have a sign: rows from above are a negative height.
std::uint64_t magnitude_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < 4; ++i) {
    value |= static_cast<std::uint32_t>(byte_at(bytes, at + i)) << (8 * i);
  }
  return value >> 31U == 0 ? value : std::uint32_t{0} - value;
}

// The first segment that begins a frame (SOF) says the size.
Size jpeg_size(std::string_view bytes) {
  for (std::size_t at = 2; at + 9 < bytes.size();) {
    if (byte_at(bytes, at) != 0xff) return std::nullopt;
    const std::uint64_t marker = byte_at(bytes, at + 1);
    if (marker == 0xff) {  // a filler
      ++at;
      continue;
    }
    const bool frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (frame) return std::pair(big_endian(bytes, at + 7, 2), big_endian(bytes, at + 5, 2));
    at += 2 + static_cast<std::size_t>(big_endian(bytes, at + 2, 2));
  }
  return std::nullopt;
}

// "P5 640 480", blanks and comments between.
Size pnm_size(std::string_view bytes) {
  std::array<std::uint64_t, 2> numbers = {};
  bytes.remove_prefix(2);
  for (std::uint64_t& number : numbers) {
    for (;;) {
      const std::size_t word = bytes.find_first_not_of(" \t\r\n");
      if (word == std::string_view::npos) return std::nullopt;
      bytes.remove_prefix(word);
      if (bytes.front() != '#') break;
      bytes.remove_prefix(std::min(bytes.find('\n'), bytes.size()));
    }
    const auto [stop, status] = std::from_chars(bytes.data(), bytes.data() + bytes.size(), number);
    if (status != std::errc()) return std::nullopt;
    bytes.remove_prefix(static_cast<std::size_t>(stop - bytes.data()));
  }
  return std::pair(numbers[0], numbers[1]);
}

bool is_pnm(std::string_view bytes) {
  return bytes.size() > 3 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6';
}

bool is_known(std::string_view bytes) {
  return bytes.starts_with(kPng) || bytes.starts_with(kJpeg) || bytes.starts_with("BM") ||
         is_pnm(bytes);
}

}  // namespace

Size picture_size(std::string_view bytes) {
  if (bytes.starts_with(kPng)) {
    return std::pair(big_endian(bytes, 16, 4), big_endian(bytes, 20, 4));
  }
  if (bytes.starts_with(kJpeg)) return jpeg_size(bytes);
  if (bytes.starts_with("BM")) return std::pair(magnitude_at(bytes, 18), magnitude_at(bytes, 22));
  return is_pnm(bytes) ? pnm_size(bytes) : std::nullopt;
}

bool is_picture(const std::filesystem::path& path) {
  const auto file = open_input(path.string());
  if (!file) return false;
  std::array<char, 16> start;
  const std::ptrdiff_t count = read_fully(file->fd.get(), start.data(), start.size());
  return count > 0 && is_known({start.data(), static_cast<std::size_t>(count)});
}

Result<cv::Mat> read_grey_picture(const std::filesystem::path& path) {
  const auto bytes = read_input(path.string(), kMaxPictureBytes);
  if (!bytes) return Error{bytes.error().message.substr(path.string().size() + 2)};
  const auto size = picture_size(*bytes);
  if (!size) return Error{"expected a picture: PNG, JPEG, BMP, PGM or PPM"};
  const auto [width, height] = *size;
  if (width > kMaxPicture_px || height > kMaxPicture_px || width * height > kMaxPicture_px) {
    return Error{"expected at most 100 megapixels, found " + std::to_string(width) + " x " +
                 std::to_string(height)};
  }
  const cv::Mat whole(1, static_cast<int>(bytes->size()), CV_8U, const_cast<char*>(bytes->data()));
  cv::Mat picture;
  try {
    picture = cv::imdecode(whole, cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception& error) {
    return Error{"cannot be decoded: " + error.err};
  }
  if (picture.empty()) return Error{"a damaged picture"};
  return picture;
}

}  // namespace zenith::tools
