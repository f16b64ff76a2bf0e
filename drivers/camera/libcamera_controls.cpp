#include "drivers/camera/libcamera_controls.h"

#include <libcamera/control_ids.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace zenith {
namespace {

namespace ids = libcamera::controls;

constexpr double kRateWorthAWarning = 0.10;

const libcamera::ControlInfo* find(const libcamera::Camera& camera,
                                   const libcamera::ControlId& id) {
  const auto entry = camera.controls().find(&id);
  return entry == camera.controls().end() ? nullptr : &entry->second;
}

// Within the control's range, where that is of the type that its documentation says.
template <typename T>
T held(const libcamera::ControlInfo& info, libcamera::ControlType type, T wanted) {
  const auto is_number = [type](const libcamera::ControlValue& value) {
    return value.type() == type && !value.isArray();
  };
  if (is_number(info.min())) wanted = std::max(wanted, info.min().get<T>());
  if (is_number(info.max())) wanted = std::min(wanted, info.max().get<T>());
  return wanted;
}

std::string number(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (!text.empty() && text.back() == '.') text.pop_back();
  return text;
}

void warn_of_change(LibcameraControls& controls, const char* what, double wanted, double got) {
  if (std::abs(wanted - got) <= 1e-6 * std::abs(wanted)) return;
  controls.warnings.push_back(std::string(what) + " is set to " + number(got) + " instead of " +
                              number(wanted) + ", the end of its range");
}

void choose_rate(const libcamera::Camera& camera, double rate_hz, LibcameraControls& controls) {
  const auto* info = find(camera, ids::FrameDurationLimits);
  if (info == nullptr) {
    controls.warnings.push_back("the camera's rate cannot be set; " + number(rate_hz) +
                                "/s was asked for");
    return;
  }
  const auto wanted_us = static_cast<std::int64_t>(std::llround(1e6 / rate_hz));
  const std::int64_t us = held(*info, libcamera::ControlTypeInteger64, wanted_us);
  controls.list.set(ids::FrameDurationLimits, {us, us});
  controls.rate_hz = 1e6 / static_cast<double>(us);
  if (std::abs(controls.rate_hz - rate_hz) > kRateWorthAWarning * rate_hz) {
    warn_of_change(controls, "the rate", rate_hz, controls.rate_hz);
  }
}

void choose_exposure(const libcamera::Camera& camera, const V4l2Settings& settings,
                     LibcameraControls& controls) {
  if (settings.exposure == V4l2Exposure::kLeave) return;
  const bool manual = settings.exposure == V4l2Exposure::kManual;
  if (find(camera, ids::AeEnable) != nullptr) {
    controls.list.set(ids::AeEnable, !manual);
  } else if (!manual) {
    controls.warnings.push_back("automatic exposure was asked for, but the camera has none");
  }
  if (!manual) return;
  const auto* info = find(camera, ids::ExposureTime);
  if (info == nullptr) {
    controls.warnings.push_back("the exposure time was asked for, but cannot be set");
    return;
  }
  const auto wanted_us = static_cast<std::int32_t>(std::lround(settings.exposure_us));
  const std::int32_t us = held(*info, libcamera::ControlTypeInteger32, wanted_us);
  controls.list.set(ids::ExposureTime, us);
  warn_of_change(controls, "the exposure time (in us)", wanted_us, us);
}

void choose_gain(const libcamera::Camera& camera, int gain, LibcameraControls& controls) {
  const auto* info = find(camera, ids::AnalogueGain);
  if (info == nullptr) {
    controls.warnings.push_back("a gain was asked for, but cannot be set");
    return;
  }
  const auto wanted = static_cast<float>(gain);
  const float got = held(*info, libcamera::ControlTypeFloat, wanted);
  controls.list.set(ids::AnalogueGain, got);
  warn_of_change(controls, "the gain", wanted, got);
}

}  // namespace

LibcameraControls choose_libcamera_controls(const libcamera::Camera& camera,
                                            const V4l2Settings& settings) {
  LibcameraControls controls;
  controls.list = libcamera::ControlList(camera.controls());
  choose_rate(camera, settings.rate_hz, controls);
  choose_exposure(camera, settings, controls);
  if (settings.gain) choose_gain(camera, *settings.gain, controls);
  if (settings.power_line != V4l2PowerLine::kLeave) {
    controls.warnings.push_back("a mains frequency was asked for, which this driver cannot set");
  }
  return controls;
}

}  // namespace zenith
