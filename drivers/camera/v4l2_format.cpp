#include "drivers/camera/v4l2_format.h"

#include <linux/videodev2.h>

#include <cerrno>
#include <cmath>

#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

constexpr double kRateWorthAWarning = 0.10;

// Both interfaces' answers in one.
struct PixFormat {
  std::uint32_t fourcc = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t field = 0;
  std::uint32_t bytes_per_line = 0;
};

PixFormat read_answer(const v4l2_format& format, bool multiplanar) {
  if (multiplanar) {
    const v4l2_pix_format_mplane& pix = format.fmt.pix_mp;
    return {pix.pixelformat, pix.width, pix.height, pix.field, pix.plane_fmt[0].bytesperline};
  }
  const v4l2_pix_format& pix = format.fmt.pix;
  return {pix.pixelformat, pix.width, pix.height, pix.field, pix.bytesperline};
}

v4l2_format write_question(const V4l2Mode& mode, bool multiplanar) {
  v4l2_format format = {};
  const auto width = static_cast<std::uint32_t>(mode.width);
  const auto height = static_cast<std::uint32_t>(mode.height);
  if (multiplanar) {
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
    format.fmt.pix_mp.width = width;
    format.fmt.pix_mp.height = height;
    format.fmt.pix_mp.pixelformat = mode.fourcc;
    format.fmt.pix_mp.field = V4L2_FIELD_NONE;
  } else {
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    format.fmt.pix.width = width;
    format.fmt.pix.height = height;
    format.fmt.pix.pixelformat = mode.fourcc;
    format.fmt.pix.field = V4L2_FIELD_NONE;
  }
  return format;
}

std::string mode_text(std::uint32_t fourcc, std::uint32_t width, std::uint32_t height) {
  return fourcc_text(fourcc) + " " + std::to_string(width) + "x" + std::to_string(height);
}

std::string refusal_advice(int error, const V4l2Offer& offer) {
  if (error == EBUSY) return "another program streams from it";
  if (offer.has_output) return "a loop-back device delivers nothing before its writer runs";
  return "the device offers: " + offer_text(offer);
}

// Sets and reads back the rate; 0 when the driver does not tell.
double set_rate(const V4l2Device& device, std::uint32_t type, const V4l2Interval& interval) {
  v4l2_streamparm parameters = {};
  parameters.type = type;
  if (device.control(VIDIOC_G_PARM, &parameters) < 0) return 0.0;
  v4l2_captureparm& capture = parameters.parm.capture;
  if ((capture.capability & V4L2_CAP_TIMEPERFRAME) != 0) {
    capture.timeperframe = {interval.numerator, interval.denominator};
    if (device.control(VIDIOC_S_PARM, &parameters) < 0) {
      parameters = {};
      parameters.type = type;
      if (device.control(VIDIOC_G_PARM, &parameters) < 0) return 0.0;
    }
  }
  return V4l2Interval{capture.timeperframe.numerator, capture.timeperframe.denominator}.rate_hz();
}

void warn_of_rate(V4l2Agreed& agreed, double wanted_hz) {
  if (agreed.rate_hz == 0.0) {
    agreed.warnings.push_back("the driver does not tell its rate; " + rate_text(wanted_hz) +
                              " was asked for");
  } else if (std::abs(agreed.rate_hz - wanted_hz) > kRateWorthAWarning * wanted_hz) {
    agreed.warnings.push_back("the driver set " + rate_text(agreed.rate_hz) + " instead of " +
                              rate_text(wanted_hz));
  }
}

}  // namespace

Result<V4l2Agreed> set_v4l2_mode(const V4l2Device& device, const V4l2Offer& offer,
                                 const V4l2Mode& mode, double rate_hz) {
  const std::string name = offer.path + " (" + offer.card + ")";
  const std::string asked = mode_text(mode.fourcc, mode.width, mode.height);
  v4l2_format format = write_question(mode, offer.multiplanar);
  const int result = device.control(VIDIOC_S_FMT, &format);
  if (result < 0) {
    return Error{name + " refused " + asked + ": " + errno_text(-result) + "; " +
                 refusal_advice(-result, offer)};
  }
  const PixFormat answer = read_answer(format, offer.multiplanar);
  if (answer.fourcc != mode.fourcc || answer.width != static_cast<std::uint32_t>(mode.width) ||
      answer.height != static_cast<std::uint32_t>(mode.height)) {
    return Error{name + " was asked for " + asked + " and set " +
                 mode_text(answer.fourcc, answer.width, answer.height) +
                 "; ask for that, or for another of: " + offer_text(offer)};
  }
  if (answer.field != V4L2_FIELD_NONE && answer.field != V4L2_FIELD_ANY) {
    return Error{name + " delivers half pictures (interlaced, field " +
                 std::to_string(answer.field) + "); a camera with whole frames is needed"};
  }
  V4l2Agreed agreed;
  agreed.luma = *find_luma_format(mode.fourcc);
  agreed.width = mode.width;
  agreed.height = mode.height;
  const std::size_t row_bytes = agreed.luma.bytes_per_pixel() * mode.width;
  agreed.stride = answer.bytes_per_line == 0 ? row_bytes : answer.bytes_per_line;
  if (agreed.stride < row_bytes) {
    return Error{name + ": rows of " + asked + " need " + std::to_string(row_bytes) +
                 " bytes, the driver says " + std::to_string(agreed.stride) +
                 "; ask for another format"};
  }
  agreed.needed_bytes = agreed.luma.needed_bytes(mode.width, mode.height, agreed.stride);
  V4l2Interval interval = mode.interval;
  if (!interval.known()) interval = choose_interval({{}, {1, 1'000'000}, {1'000'000, 1}}, rate_hz);
  agreed.rate_hz = set_rate(device, format.type, interval);
  warn_of_rate(agreed, interval.rate_hz());
  return agreed;
}

}  // namespace zenith
