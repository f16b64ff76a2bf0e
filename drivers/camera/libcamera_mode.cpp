#include "drivers/camera/libcamera_mode.h"

#include <libcamera/formats.h>
#include <libcamera/property_ids.h>
#include <linux/videodev2.h>

#include <array>
#include <utility>

namespace zenith {
namespace {

using libcamera::PixelFormat;
using libcamera::StreamConfiguration;

struct Pair {
  PixelFormat theirs;
  std::uint32_t fourcc;
};

// libcamera names formats as DRM does: the colours of RGB888 lie in memory from blue to red.
const std::array<Pair, 9>& readable_formats() {
  static const std::array<Pair, 9> kPairs = {{
      {libcamera::formats::R8, V4L2_PIX_FMT_GREY},
      {libcamera::formats::NV12, V4L2_PIX_FMT_NV12},
      {libcamera::formats::YUV420, V4L2_PIX_FMT_YUV420},
      {libcamera::formats::NV21, V4L2_PIX_FMT_NV21},
      {libcamera::formats::YVU420, V4L2_PIX_FMT_YVU420},
      {libcamera::formats::YUYV, V4L2_PIX_FMT_YUYV},
      {libcamera::formats::UYVY, V4L2_PIX_FMT_UYVY},
      {libcamera::formats::BGR888, V4L2_PIX_FMT_RGB24},
      {libcamera::formats::RGB888, V4L2_PIX_FMT_BGR24},
  }};
  return kPairs;
}

std::string size_text(const libcamera::Size& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

std::string offer_text(const StreamConfiguration& stream) {
  constexpr std::size_t kMostSizes = 12;
  std::string text;
  for (const PixelFormat& format : stream.formats().pixelformats()) {
    text += (text.empty() ? "" : "; ") + format.toString();
    const auto sizes = stream.formats().sizes(format);
    for (std::size_t i = 0; i < sizes.size() && i < kMostSizes; ++i) {
      text += (i == 0 ? " " : ", ") + size_text(sizes[i]);
    }
    if (sizes.size() > kMostSizes) {
      text += ", ... (" + stream.formats().range(format).toString() + ")";
    }
  }
  return text.empty() ? "nothing by name" : text;
}

bool may_be_read(const Pair& pair, const V4l2Settings& settings) {
  if (settings.format == "auto") return true;
  return settings.format == pair.theirs.toString() || fourcc_of(settings.format) == pair.fourcc;
}

// Whether the camera takes exactly this.
bool takes(libcamera::CameraConfiguration& configuration, const PixelFormat& format,
           const V4l2Settings& settings) {
  const libcamera::Size size(static_cast<unsigned>(settings.width),
                             static_cast<unsigned>(settings.height));
  StreamConfiguration& stream = configuration.at(0);
  stream.pixelFormat = format;
  stream.size = size;
  stream.stride = 0;
  stream.bufferCount = static_cast<unsigned>(settings.buffers);
  return configuration.validate() != libcamera::CameraConfiguration::Invalid &&
         stream.pixelFormat == format && stream.size == size;
}

}  // namespace

std::string libcamera_name(const libcamera::Camera& camera) {
  const auto model = camera.properties().get(libcamera::properties::Model);
  return (model ? *model + " " : "") + camera.id();
}

Result<std::shared_ptr<libcamera::Camera>> find_libcamera_camera(
    const libcamera::CameraManager& manager, const std::string& part) {
  std::string known;
  std::shared_ptr<libcamera::Camera> found;
  int count = 0;
  for (const auto& camera : manager.cameras()) {
    const std::string name = libcamera_name(*camera);
    known += (known.empty() ? "'" : ", '") + name + "'";
    if (name.find(part) == std::string::npos) continue;
    found = camera;
    ++count;
  }
  if (count == 1) return found;
  const std::string has = known.empty() ? "libcamera knows no camera here: is it plugged in, and "
                                          "does its kernel driver run?"
                                        : "libcamera has " + known;
  if (part.empty()) return Error{count == 0 ? has : has + "; name a part of one of them"};
  if (count == 0) return Error{"no camera of libcamera is named '" + part + "'; " + has};
  return Error{"'" + part + "' names several cameras; " + has};
}

Result<LibcameraMode> negotiate_libcamera(libcamera::Camera& camera, const V4l2Settings& settings) {
  LibcameraMode mode;
  mode.configuration = camera.generateConfiguration({libcamera::StreamRole::VideoRecording});
  if (!mode.configuration || mode.configuration->empty()) {
    mode.configuration = camera.generateConfiguration({libcamera::StreamRole::Viewfinder});
  }
  const std::string name = libcamera_name(camera);
  if (!mode.configuration || mode.configuration->empty()) {
    return Error{name + " offers no stream of video; another camera is needed"};
  }
  const std::string offer = offer_text(mode.configuration->at(0));
  for (const LumaFormat& luma : luma_formats()) {
    for (const Pair& pair : readable_formats()) {
      if (pair.fourcc != luma.fourcc || !may_be_read(pair, settings)) continue;
      if (!takes(*mode.configuration, pair.theirs, settings)) continue;
      mode.luma = luma;
      return mode;
    }
  }
  return Error{name + ": asked for " + std::to_string(settings.width) + "x" +
               std::to_string(settings.height) + ", format " + settings.format +
               ", which cannot be had in a format that is read (grey, YUV or 24-bit colour). It "
               "offers: " +
               offer + "."};
}

}  // namespace zenith
