#include "drivers/camera/v4l2_offer.h"

#include <cstdio>

#include "drivers/camera/luma_format.h"

namespace zenith {
namespace {

bool in_steps(int value, std::uint32_t min, std::uint32_t max, std::uint32_t step) {
  if (value <= 0) return false;
  const auto v = static_cast<std::uint32_t>(value);
  return v >= min && v <= max && (step <= 1 || (v - min) % step == 0);
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g", value);
  return text;
}

std::string size_text(const V4l2SizeOffer& size) {
  std::string text = std::to_string(size.min_width) + "x" + std::to_string(size.min_height);
  if (size.is_range()) {
    text += " to " + std::to_string(size.max_width) + "x" + std::to_string(size.max_height);
  }
  return size.rates.unknown() ? text : text + " at " + rates_text(size.rates);
}

}  // namespace

bool V4l2SizeOffer::holds(int width, int height) const {
  return in_steps(width, min_width, max_width, step_width) &&
         in_steps(height, min_height, max_height, step_height);
}

std::string rate_text(double rate_hz) {
  return number(rate_hz) + "/s";
}

std::string rates_text(const V4l2Rates& rates) {
  if (rates.is_range()) {
    return number(rates.longest.rate_hz()) + " to " + rate_text(rates.shortest.rate_hz());
  }
  std::string text;
  for (const V4l2Interval& interval : rates.discrete) {
    text += (text.empty() ? "" : ", ") + number(interval.rate_hz());
  }
  return text.empty() ? "any rate" : text + "/s";
}

std::string offer_text(const V4l2Offer& offer) {
  std::string text;
  for (const V4l2FormatOffer& format : offer.formats) {
    text += (text.empty() ? "" : "; ") + fourcc_text(format.fourcc);
    if (format.compressed) text += " (compressed)";
    for (std::size_t i = 0; i < format.sizes.size(); ++i) {
      text += (i == 0 ? " " : ", ") + size_text(format.sizes[i]);
    }
  }
  return text.empty() ? "no format" : text;
}

}  // namespace zenith
