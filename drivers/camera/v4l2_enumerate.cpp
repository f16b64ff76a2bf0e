#include "drivers/camera/v4l2_enumerate.h"

#include <linux/videodev2.h>

#include <cstring>

namespace zenith {
namespace {

// Far above what cameras list; a driver that never says "enough" must not hold the program.
constexpr std::uint32_t kMaxEntries = 256;

V4l2Interval interval_of(const v4l2_fract& fraction) {
  return {fraction.numerator, fraction.denominator};
}

V4l2Rates enumerate_rates(const V4l2Device& device, std::uint32_t fourcc, std::uint32_t width,
                          std::uint32_t height) {
  V4l2Rates rates;
  for (std::uint32_t i = 0; i < kMaxEntries; ++i) {
    v4l2_frmivalenum entry = {};
    entry.index = i;
    entry.pixel_format = fourcc;
    entry.width = width;
    entry.height = height;
    if (device.control(VIDIOC_ENUM_FRAMEINTERVALS, &entry) < 0) break;
    if (entry.type == V4L2_FRMIVAL_TYPE_DISCRETE) {
      const V4l2Interval interval = interval_of(entry.discrete);
      if (interval.known()) rates.discrete.push_back(interval);
      continue;
    }
    rates.shortest = interval_of(entry.stepwise.min);
    rates.longest = interval_of(entry.stepwise.max);
    break;
  }
  return rates;
}

V4l2SizeOffer size_of(const v4l2_frmsizeenum& entry) {
  if (entry.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
    return {entry.discrete.width,
            entry.discrete.width,
            1,
            entry.discrete.height,
            entry.discrete.height,
            1,
            {}};
  }
  const v4l2_frmsize_stepwise& range = entry.stepwise;
  return {range.min_width,
          range.max_width,
          range.step_width,
          range.min_height,
          range.max_height,
          range.step_height,
          {}};
}

std::vector<V4l2SizeOffer> enumerate_sizes(const V4l2Device& device, std::uint32_t fourcc,
                                           int width, int height) {
  std::vector<V4l2SizeOffer> sizes;
  for (std::uint32_t i = 0; i < kMaxEntries; ++i) {
    v4l2_frmsizeenum entry = {};
    entry.index = i;
    entry.pixel_format = fourcc;
    if (device.control(VIDIOC_ENUM_FRAMESIZES, &entry) < 0) break;
    V4l2SizeOffer size = size_of(entry);
    const bool asked = size.holds(width, height);
    size.rates = enumerate_rates(device, fourcc, asked ? width : size.max_width,
                                 asked ? height : size.max_height);
    sizes.push_back(std::move(size));
    if (entry.type != V4L2_FRMSIZE_TYPE_DISCRETE) break;
  }
  return sizes;
}

}  // namespace

Result<V4l2Offer> enumerate_v4l2(const V4l2Device& device, const std::string& path, int width,
                                 int height) {
  auto offer = read_identity(device, path);
  if (!offer || !offer->captures) return offer;
  for (std::uint32_t i = 0; i < kMaxEntries; ++i) {
    v4l2_fmtdesc entry = {};
    entry.index = i;
    entry.type =
        offer->multiplanar ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (device.control(VIDIOC_ENUM_FMT, &entry) < 0) break;
    V4l2FormatOffer format;
    format.fourcc = entry.pixelformat;
    format.compressed = (entry.flags & V4L2_FMT_FLAG_COMPRESSED) != 0;
    const char* description = reinterpret_cast<const char*>(entry.description);
    format.description.assign(description, ::strnlen(description, sizeof(entry.description)));
    format.sizes = enumerate_sizes(device, entry.pixelformat, width, height);
    offer->formats.push_back(std::move(format));
  }
  return offer;
}

}  // namespace zenith
