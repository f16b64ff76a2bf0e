#include "drivers/camera/v4l2_controls.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <optional>

#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

constexpr std::uint32_t kMaxControls = 512;  // a driver that never ends its list must not hold us
constexpr int kMaxChoices = 64;

std::optional<v4l2_queryctrl> query(const V4l2Device& device, std::uint32_t id) {
  v4l2_queryctrl entry = {};
  entry.id = id;
  if (device.control(VIDIOC_QUERYCTRL, &entry) < 0) return std::nullopt;
  if ((entry.flags & V4L2_CTRL_FLAG_DISABLED) != 0) return std::nullopt;
  return entry;
}

bool settable(const V4l2Device& device, std::uint32_t id) {
  const auto entry = query(device, id);
  return entry && (entry->flags & V4L2_CTRL_FLAG_READ_ONLY) == 0;
}

std::string name_of(const v4l2_queryctrl& entry) {
  const char* name = reinterpret_cast<const char*>(entry.name);
  return {name, ::strnlen(name, sizeof(entry.name))};
}

bool has_choice(const V4l2Device& device, std::uint32_t id, int index) {
  v4l2_querymenu item = {};
  item.id = id;
  item.index = static_cast<std::uint32_t>(index);
  return device.control(VIDIOC_QUERYMENU, &item) >= 0;
}

class Setter {
 public:
  Setter(const V4l2Device& device, std::vector<std::string>& warnings)
      : device_(device), warnings_(warnings) {}

  void warn(const std::string& text) { warnings_.push_back(text); }

  // The first of `ids` that the device has; 0 when it has none.
  std::uint32_t first_of(std::initializer_list<std::uint32_t> ids) const {
    for (const std::uint32_t id : ids) {
      if (settable(device_, id)) return id;
    }
    return 0;
  }

  // Within the control's range; says so when that changes the value.
  void set_number(std::uint32_t id, const char* what, double wanted) {
    const auto entry = query(device_, id);
    if (!entry) return;
    const double held = std::clamp(wanted, double(entry->minimum), double(entry->maximum));
    if (held != wanted) {
      warn(std::string(what) + " is set to " + std::to_string(std::lround(held)) + " instead of " +
           std::to_string(std::lround(wanted)) + ": '" + name_of(*entry) + "' goes from " +
           std::to_string(entry->minimum) + " to " + std::to_string(entry->maximum));
    }
    set(id, what, static_cast<int>(std::lround(held)));
  }

  void set(std::uint32_t id, const char* what, int value) {
    v4l2_control control = {};
    control.id = id;
    control.value = value;
    const int result = device_.control(VIDIOC_S_CTRL, &control);
    if (result < 0) warn(std::string(what) + " could not be set: " + errno_text(-result));
  }

  // The first choice that the menu has.
  bool set_choice(std::uint32_t id, const char* what, std::initializer_list<int> values) {
    for (const int value : values) {
      if (!has_choice(device_, id, value)) continue;
      set(id, what, value);
      return true;
    }
    return false;
  }

 private:
  const V4l2Device& device_;
  std::vector<std::string>& warnings_;
};

std::optional<double> read_int64(const V4l2Device& device, std::uint32_t id) {
  v4l2_ext_control control = {};
  control.id = id;
  v4l2_ext_controls controls = {};
  controls.which = V4L2_CTRL_WHICH_CUR_VAL;
  controls.count = 1;
  controls.controls = &control;
  if (device.control(VIDIOC_G_EXT_CTRLS, &controls) < 0) return std::nullopt;
  return static_cast<double>(control.value64);
}

std::optional<double> read_int(const V4l2Device& device, std::uint32_t id) {
  v4l2_control control = {};
  control.id = id;
  if (device.control(VIDIOC_G_CTRL, &control) < 0) return std::nullopt;
  return control.value;
}

// Sensors expose by lines: line time = (width + horizontal blanking) / pixel rate.
std::optional<double> line_us(const V4l2Device& device, int width) {
  const auto pixel_rate = read_int64(device, V4L2_CID_PIXEL_RATE);
  const auto blanking = read_int(device, V4L2_CID_HBLANK);
  if (!pixel_rate || !blanking || *pixel_rate <= 0.0) return std::nullopt;
  return 1e6 * (width + *blanking) / *pixel_rate;
}

void set_exposure_time(const V4l2Device& device, const V4l2Settings& settings, Setter& setter) {
  constexpr double kAbsoluteUnit_us = 100.0;
  if (settable(device, V4L2_CID_EXPOSURE_ABSOLUTE)) {
    setter.set_number(V4L2_CID_EXPOSURE_ABSOLUTE, "the exposure time (in 100 us)",
                      settings.exposure_us / kAbsoluteUnit_us);
    return;
  }
  const auto line = line_us(device, settings.width);
  if (line && settable(device, V4L2_CID_EXPOSURE)) {
    setter.set_number(V4L2_CID_EXPOSURE, "the exposure time (in lines)",
                      settings.exposure_us / *line);
    return;
  }
  setter.warn("the exposure time was asked for, but the camera has no control in known units");
}

void set_exposure(const V4l2Device& device, const V4l2Settings& settings, Setter& setter) {
  if (settings.exposure == V4l2Exposure::kLeave) return;
  const bool manual = settings.exposure == V4l2Exposure::kManual;
  if (settable(device, V4L2_CID_EXPOSURE_AUTO)) {
    constexpr const char* kWhat = "the exposure mode";
    const bool set = manual
                         ? setter.set_choice(V4L2_CID_EXPOSURE_AUTO, kWhat,
                                             {V4L2_EXPOSURE_MANUAL, V4L2_EXPOSURE_SHUTTER_PRIORITY})
                         : setter.set_choice(V4L2_CID_EXPOSURE_AUTO, kWhat,
                                             {V4L2_EXPOSURE_APERTURE_PRIORITY, V4L2_EXPOSURE_AUTO});
    if (!set) setter.warn("the camera's exposure mode has not the choice that was asked for");
  } else if (!manual) {
    setter.warn("automatic exposure was asked for, but the camera has no such control");
  }
  // Without this many webcams lower their rate in the dark.
  if (settable(device, V4L2_CID_EXPOSURE_AUTO_PRIORITY)) {
    setter.set(V4L2_CID_EXPOSURE_AUTO_PRIORITY, "the priority of the rate over exposure", 0);
  }
  if (manual) set_exposure_time(device, settings, setter);
}

void set_gain(const V4l2Device& device, int gain, Setter& setter) {
  if (settable(device, V4L2_CID_AUTOGAIN)) {
    setter.set(V4L2_CID_AUTOGAIN, "automatic gain off", 0);
  }
  const std::uint32_t id = setter.first_of({V4L2_CID_GAIN, V4L2_CID_ANALOGUE_GAIN});
  if (id == 0) {
    setter.warn("a gain was asked for, but the camera has no such control");
    return;
  }
  setter.set_number(id, "the gain", gain);
}

void set_power_line(const V4l2Device& device, V4l2PowerLine asked, Setter& setter) {
  if (asked == V4l2PowerLine::kLeave) return;
  if (!settable(device, V4L2_CID_POWER_LINE_FREQUENCY)) {
    setter.warn("a mains frequency was asked for, but the camera has no such control");
    return;
  }
  int value = V4L2_CID_POWER_LINE_FREQUENCY_DISABLED;
  if (asked == V4l2PowerLine::k50Hz) value = V4L2_CID_POWER_LINE_FREQUENCY_50HZ;
  if (asked == V4l2PowerLine::k60Hz) value = V4L2_CID_POWER_LINE_FREQUENCY_60HZ;
  if (asked == V4l2PowerLine::kAuto) value = V4L2_CID_POWER_LINE_FREQUENCY_AUTO;
  if (!setter.set_choice(V4L2_CID_POWER_LINE_FREQUENCY, "the mains frequency", {value})) {
    setter.warn("the camera's mains frequency has not the choice that was asked for");
  }
}

std::vector<std::string> list_choices(const V4l2Device& device, const v4l2_queryctrl& entry) {
  std::vector<std::string> choices;
  if (entry.type != V4L2_CTRL_TYPE_MENU) return choices;
  for (int i = std::max(entry.minimum, 0); i <= std::min(entry.maximum, kMaxChoices); ++i) {
    v4l2_querymenu item = {};
    item.id = entry.id;
    item.index = static_cast<std::uint32_t>(i);
    if (device.control(VIDIOC_QUERYMENU, &item) < 0) continue;
    const char* name = reinterpret_cast<const char*>(item.name);
    choices.push_back(std::to_string(i) + ": " +
                      std::string(name, ::strnlen(name, sizeof(item.name))));
  }
  return choices;
}

}  // namespace

std::vector<V4l2Control> list_v4l2_controls(const V4l2Device& device) {
  std::vector<V4l2Control> controls;
  v4l2_queryctrl entry = {};
  for (std::uint32_t i = 0; i < kMaxControls; ++i) {
    const std::uint32_t previous = entry.id;
    entry = {};
    entry.id = previous | V4L2_CTRL_FLAG_NEXT_CTRL;
    if (device.control(VIDIOC_QUERYCTRL, &entry) < 0) break;
    if ((entry.flags & V4L2_CTRL_FLAG_DISABLED) != 0) continue;
    if (entry.type != V4L2_CTRL_TYPE_INTEGER && entry.type != V4L2_CTRL_TYPE_BOOLEAN &&
        entry.type != V4L2_CTRL_TYPE_MENU) {
      continue;
    }
    V4l2Control control = {entry.id,
                           name_of(entry),
                           entry.minimum,
                           entry.maximum,
                           entry.step,
                           entry.default_value,
                           0,
                           false,
                           {}};
    control.value = static_cast<int>(read_int(device, entry.id).value_or(entry.default_value));
    control.read_only = (entry.flags & V4L2_CTRL_FLAG_READ_ONLY) != 0;
    control.choices = list_choices(device, entry);
    controls.push_back(std::move(control));
  }
  return controls;
}

std::vector<std::string> apply_v4l2_controls(const V4l2Device& device,
                                             const V4l2Settings& settings) {
  std::vector<std::string> warnings;
  Setter setter(device, warnings);
  set_exposure(device, settings, setter);
  if (settings.gain) set_gain(device, *settings.gain, setter);
  set_power_line(device, settings.power_line, setter);
  return warnings;
}

}  // namespace zenith
