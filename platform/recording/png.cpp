#include "platform/recording/png.h"

#include <fcntl.h>
#include <spng.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include "platform/linux/errno_text.h"
#include "platform/linux/input_file.h"

namespace zenith {
namespace {

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};
using File = std::unique_ptr<std::FILE, Close>;
using Context = std::unique_ptr<spng_ctx, Close>;

std::string size_text(std::uint32_t width, std::uint32_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

// What may stand in a file beside its picture: texts, a colour profile. libspng unpacks them too.
constexpr std::uint64_t kMaxBesideBytes = std::uint64_t{1} << 20U;
constexpr std::size_t kMaxUnpackedChunk = std::size_t{1} << 20U;
constexpr std::size_t kMaxUnpacked = std::size_t{4} << 20U;

Error broken(const std::string& name, int code) {
  if (code == SPNG_ECHUNK_LIMITS || code == SPNG_EMEM) {
    return {name + ": what stands beside the picture unpacks to more than " +
            bytes_text(kMaxUnpackedChunk) + " in a piece or " + bytes_text(kMaxUnpacked) +
            " in all; write the file anew without texts and profiles"};
  }
  return {name + ": damaged or truncated PNG file (" + spng_strerror(code) + ")"};
}

std::string kind_text(const spng_ihdr& header) {
  const char* colours = "an unknown kind of colours";
  if (header.color_type == SPNG_COLOR_TYPE_GRAYSCALE) colours = "grey";
  if (header.color_type == SPNG_COLOR_TYPE_TRUECOLOR) colours = "colour";
  if (header.color_type == SPNG_COLOR_TYPE_INDEXED) colours = "a palette";
  if (header.color_type == SPNG_COLOR_TYPE_GRAYSCALE_ALPHA) colours = "grey with transparency";
  if (header.color_type == SPNG_COLOR_TYPE_TRUECOLOR_ALPHA) colours = "colour with transparency";
  return std::to_string(header.bit_depth) + "-bit " + colours +
         (header.interlace_method == 0 ? "" : ", interlaced");
}

// The bytes of all chunks that are no pixels, as far as the file is whole.
std::uint64_t bytes_beside(std::string_view png) {
  constexpr std::size_t kSignature = 8;
  constexpr std::size_t kFrame = 12;  // length, type, checksum
  const auto byte = [png](std::size_t i) { return static_cast<std::uint64_t>(png[i] & 0xff); };
  std::uint64_t beside = 0;
  for (std::uint64_t at = kSignature; at + kFrame <= png.size();) {
    const std::uint64_t size =
        kFrame + (byte(at) << 24U | byte(at + 1) << 16U | byte(at + 2) << 8U | byte(at + 3));
    if (png.substr(at + 4, 4) != "IDAT") beside += size;
    at += size;
  }
  return beside;
}

Status check_header(const spng_ihdr& header, const std::string& name, int width, int height) {
  if (header.bit_depth != 8 || header.color_type != SPNG_COLOR_TYPE_GRAYSCALE ||
      header.interlace_method != 0) {
    return Error{name + ": expected an 8-bit grey image, not interlaced, found " +
                 kind_text(header)};
  }
  const auto expected_width = static_cast<std::uint32_t>(width);
  const auto expected_height = static_cast<std::uint32_t>(height);
  if (header.width == expected_width && header.height == expected_height) return {};
  return Error{name + ": the image is " + size_text(header.width, header.height) +
               ", sensor.yaml says " + size_text(expected_width, expected_height)};
}

}  // namespace

Status parse_grey_png(std::string_view png, const std::string& name, int width, int height,
                      std::vector<std::uint8_t>& pixels) {
  const std::uint64_t beside = bytes_beside(png);
  if (beside > kMaxBesideBytes) {
    return Error{name + ": expected at most " + bytes_text(kMaxBesideBytes) +
                 " beside the picture, found " + bytes_text(beside)};
  }
  const Context context(spng_ctx_new(0));
  if (!context) return Error{name + ": no memory to decode it"};
  spng_set_crc_action(context.get(), SPNG_CRC_ERROR, SPNG_CRC_ERROR);
  spng_set_chunk_limits(context.get(), kMaxUnpackedChunk, kMaxUnpacked);
  if (const int code = spng_set_png_buffer(context.get(), png.data(), png.size()); code != 0) {
    return broken(name, code);
  }
  spng_ihdr header = {};
  if (const int code = spng_get_ihdr(context.get(), &header); code != 0) return broken(name, code);
  if (const Status good = check_header(header, name, width, height); !good) return good;
  pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const int code = spng_decode_image(context.get(), pixels.data(), pixels.size(), SPNG_FMT_PNG, 0);
  if (code != 0) return broken(name, code);
  return {};
}

Status read_grey_png(const std::filesystem::path& path, int width, int height,
                     std::vector<std::uint8_t>& pixels) {
  // Pixels that do not compress take a little more than themselves.
  const std::uint64_t raw = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  const auto png = read_input(path.string(), 2 * raw + 2 * kMaxBesideBytes);
  if (!png) return png.error();
  return parse_grey_png(*png, path.string(), width, height, pixels);
}

Status write_grey_png(const std::filesystem::path& path, ImageView image, int compression) {
  constexpr int kNew = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
  UniqueFd file(::open(path.c_str(), kNew, 0666));
  if (!file.is_open()) return Error{path.string() + ": cannot be created: " + errno_text(errno)};
  return write_grey_png(std::move(file), path, image, compression);
}

Status write_grey_png(UniqueFd fd, const std::filesystem::path& path, ImageView image,
                      int compression) {
  const File file(::fdopen(fd.get(), "wb"));
  if (!file) return Error{path.string() + ": cannot be written: " + errno_text(errno)};
  (void)fd.release();
  const Context context(spng_ctx_new(SPNG_CTX_ENCODER));
  spng_set_png_file(context.get(), file.get());
  spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, compression);
  spng_set_option(context.get(), SPNG_FILTER_CHOICE, SPNG_FILTER_CHOICE_UP);
  spng_ihdr header = {};
  header.width = static_cast<std::uint32_t>(image.width);
  header.height = static_cast<std::uint32_t>(image.height);
  header.bit_depth = 8;
  header.color_type = SPNG_COLOR_TYPE_GRAYSCALE;
  spng_set_ihdr(context.get(), &header);
  int code = spng_encode_image(context.get(), nullptr, 0, SPNG_FMT_PNG,
                               SPNG_ENCODE_PROGRESSIVE | SPNG_ENCODE_FINALIZE);
  for (int v = 0; v < image.height && code == 0; ++v) {
    code = spng_encode_row(context.get(), image.row(v), static_cast<std::size_t>(image.width));
  }
  if (code != 0 && code != SPNG_EOI) {
    return Error{path.string() + ": cannot be written (" + spng_strerror(code) + ")"};
  }
  if (std::fflush(file.get()) != 0) {
    return Error{path.string() + ": cannot be written: " + errno_text(errno)};
  }
  return {};
}

}  // namespace zenith
