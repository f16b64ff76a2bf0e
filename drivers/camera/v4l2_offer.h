#pragma once
// What a V4L2 device offers, as plain data: filled by v4l2_enumerate, judged by v4l2_negotiation.

#include <cstdint>
#include <string>
#include <vector>

namespace zenith {

// Seconds between two frames, as the driver writes it.
struct V4l2Interval {
  std::uint32_t numerator = 0;
  std::uint32_t denominator = 0;

  bool known() const { return numerator > 0 && denominator > 0; }
  double rate_hz() const { return known() ? double(denominator) / double(numerator) : 0.0; }
};

// Either single intervals, or a range from shortest to longest, or nothing: the driver does not
// say.
struct V4l2Rates {
  std::vector<V4l2Interval> discrete;
  V4l2Interval shortest;
  V4l2Interval longest;

  bool is_range() const { return shortest.known() && longest.known(); }
  bool unknown() const { return discrete.empty() && !is_range(); }
};

// One size, or all from min to max in steps.
struct V4l2SizeOffer {
  std::uint32_t min_width = 0;
  std::uint32_t max_width = 0;
  std::uint32_t step_width = 1;
  std::uint32_t min_height = 0;
  std::uint32_t max_height = 0;
  std::uint32_t step_height = 1;
  V4l2Rates rates;  // of a range: at the size that was asked for, when it is within

  bool is_range() const { return min_width != max_width || min_height != max_height; }
  bool holds(int width, int height) const;
};

struct V4l2FormatOffer {
  std::uint32_t fourcc = 0;
  bool compressed = false;
  std::string description;           // the driver's words
  std::vector<V4l2SizeOffer> sizes;  // empty: the driver does not say
};

struct V4l2Offer {
  std::string path;  // "/dev/video0"
  std::string driver;
  std::string card;
  std::string bus;
  bool captures = false;     // frames come out of it now
  bool streams = false;      // by memory mapping
  bool multiplanar = false;  // by the multi-planar interface alone
  bool has_output = false;   // frames go into it: a loop-back device, or a codec
  std::vector<V4l2FormatOffer> formats;
};

// For a person, in one line: "GREY 640x480 at 30, 60/s; MJPG (compressed) 1280x720 at 30/s".
std::string offer_text(const V4l2Offer& offer);
std::string rates_text(const V4l2Rates& rates);
std::string rate_text(double rate_hz);  // "30/s", "7.5/s"

}  // namespace zenith
