// Any bytes as a frame: a picture of the size that was asked for, or an error. The checksums of
// chunks, which no fuzzer finds by itself, are mended when the last byte says so.

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "platform/recording/png.h"
#include "platform/storage/checksum.h"
#include "tests/fuzz/require.h"

namespace {

constexpr std::size_t kSignature = 8;
constexpr std::size_t kMostSide_px = 256;

std::size_t number_at(const std::string& png, std::size_t at) {
  std::size_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8U | static_cast<unsigned char>(png[at + i]);
  return value;
}

void mend(std::string& png) {
  for (std::size_t at = kSignature; at + 12 <= png.size();) {
    const std::size_t length = number_at(png, at);
    if (length > png.size() - at - 12) return;
    const auto* type = reinterpret_cast<const std::uint8_t*>(png.data() + at + 4);
    const std::uint32_t crc = zenith::storage::crc32({type, length + 4});
    for (std::size_t i = 0; i < 4; ++i) {
      png[at + 8 + length + i] = static_cast<char>(crc >> (24 - 8 * i));
    }
    at += 12 + length;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string png(reinterpret_cast<const char*>(data), size);
  if (!png.empty() && png.back() == 'm') {
    png.pop_back();
    mend(png);
  }
  // What the header says, within reason: else nothing behind it would be reached.
  std::size_t width = 16;
  std::size_t height = 12;
  if (png.size() >= 24) {
    width = std::clamp<std::size_t>(number_at(png, 16), 1, kMostSide_px);
    height = std::clamp<std::size_t>(number_at(png, 20), 1, kMostSide_px);
  }
  std::vector<std::uint8_t> pixels;
  const zenith::Status read = zenith::parse_grey_png(png, "frame.png", static_cast<int>(width),
                                                     static_cast<int>(height), pixels);
  require(pixels.empty() || pixels.size() == width * height);
  require(!read || !pixels.empty());
  require(read || read.error().message.starts_with("frame.png: "));
  return 0;
}
