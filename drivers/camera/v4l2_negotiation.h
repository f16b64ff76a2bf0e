#pragma once
// Chooses format, size and rate among what a device offers. Pure.
//
// The size must be offered exactly. Of the formats that can be read, those that reach the rate come
// first, among them the cheapest to read (luma_format.h); when none reaches it, the fastest.

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/camera/v4l2_offer.h"
#include "drivers/camera/v4l2_settings.h"
#include "platform/base/result.h"

namespace zenith {

struct V4l2Mode {
  std::uint32_t fourcc = 0;
  int width = 0;
  int height = 0;
  V4l2Interval interval;  // unknown: the driver does not say which rates it has
  std::vector<std::string> warnings;
};

// The error says what was asked for, why it cannot be had, and all that the device offers.
Result<V4l2Mode> negotiate_v4l2(const V4l2Offer& offer, const V4l2Settings& settings);

// The slowest interval that is not slower than `rate_hz` (by more than 2 %), else the fastest.
V4l2Interval choose_interval(const V4l2Rates& rates, double rate_hz);

}  // namespace zenith
