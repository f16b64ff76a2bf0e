#include "platform/recording/png.h"

#include <spng.h>

#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

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

Error broken(const std::filesystem::path& path, int code) {
  return {path.string() + ": damaged or truncated PNG file (" + spng_strerror(code) + ")"};
}

}  // namespace

Status read_grey_png(const std::filesystem::path& path, int width, int height,
                     std::vector<std::uint8_t>& pixels) {
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file) return Error{path.string() + ": cannot be opened: " + std::strerror(errno)};
  const Context context(spng_ctx_new(0));
  spng_set_crc_action(context.get(), SPNG_CRC_ERROR, SPNG_CRC_ERROR);
  if (const int code = spng_set_png_file(context.get(), file.get()); code != 0) {
    return broken(path, code);
  }
  spng_ihdr header = {};
  if (const int code = spng_get_ihdr(context.get(), &header); code != 0) return broken(path, code);
  if (header.bit_depth != 8 || header.color_type != SPNG_COLOR_TYPE_GRAYSCALE) {
    return Error{path.string() + ": expected an 8-bit grey image"};
  }
  if (header.width != static_cast<std::uint32_t>(width) ||
      header.height != static_cast<std::uint32_t>(height)) {
    return Error{path.string() + ": the image is " + size_text(header.width, header.height) +
                 ", sensor.yaml says " +
                 size_text(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height))};
  }
  pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const int code = spng_decode_image(context.get(), pixels.data(), pixels.size(), SPNG_FMT_PNG, 0);
  if (code != 0) return broken(path, code);
  return {};
}

Status write_grey_png(const std::filesystem::path& path, ImageView image, int compression) {
  const File file(std::fopen(path.c_str(), "wb"));
  if (!file) return Error{path.string() + ": cannot be created: " + std::strerror(errno)};
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
    return Error{path.string() + ": cannot be written: " + std::strerror(errno)};
  }
  return {};
}

}  // namespace zenith
