#include "drivers/camera/v4l2_settings.h"

#include <cmath>

#include "drivers/camera/luma_format.h"

namespace zenith {
namespace {

constexpr int kMaxSide_px = 16384;
constexpr int kMinBuffers = 2;
constexpr int kMaxBuffers = 32;
constexpr double kMaxRate_hz = 1000.0;
constexpr double kMaxPatience_s = 3600.0;

bool within(double value, double low, double high) {
  return std::isfinite(value) && value >= low && value <= high;
}

}  // namespace

Status check_settings(const V4l2Settings& settings) {
  std::string wrong;
  const auto add = [&wrong](const std::string& text) {
    wrong += (wrong.empty() ? "" : "; ") + text;
  };
  if (!within(settings.width, 1, kMaxSide_px) || !within(settings.height, 1, kMaxSide_px)) {
    add("width and height must be 1 to 16384, not " + std::to_string(settings.width) + "x" +
        std::to_string(settings.height));
  }
  if (!within(settings.rate_hz, 0.01, kMaxRate_hz)) {
    add("rate_hz must be 0.01 to 1000, not " + std::to_string(settings.rate_hz));
  }
  if (!within(settings.buffers, kMinBuffers, kMaxBuffers)) {
    add("buffers must be 2 to 32, not " + std::to_string(settings.buffers));
  }
  if (!within(settings.stall_s, 0.01, kMaxPatience_s) ||
      !within(settings.first_frame_s, 0.01, kMaxPatience_s)) {
    add("stall_s and first_frame_s must be 0.01 to 3600");
  }
  if (settings.format != "auto" && fourcc_of(settings.format) == 0) {
    add("format must be \"auto\" or four characters, not '" + settings.format + "'");
  }
  if (wrong.empty()) return {};
  return Error{"settings of the camera " + settings.device + ": " + wrong};
}

}  // namespace zenith
