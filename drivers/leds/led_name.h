#pragma once
// How the configuration names an LED.

#include <array>
#include <string>
#include <string_view>

#include "drivers/leds/led_pattern.h"
#include "platform/base/result.h"

namespace zenith {

struct LedSetting {
  // "gpio:NAME"                    a GPIO line by its name, on whatever chip
  // "gpiochip-label:LABEL:OFFSET"  a line of the chip with this label
  // "gpiochip:/dev/gpiochipN:OFFSET"  a line of this chip; N may change from boot to boot
  // "led:NAME"                     an LED of the kernel, in /sys/class/leds
  // ""                             there is none
  std::string name;
  bool active_low = false;  // lit when the line is low; of GPIO lines only
};

// In the order of the bits of LedMask: status, peer, fault.
struct LedSettings {
  std::array<LedSetting, kLedCount> leds;
};

enum class LedKind { kNone, kLineName, kChipLabel, kChipPath, kLedClass };

struct LedName {
  LedKind kind = LedKind::kNone;
  std::string text;     // line name, chip label, chip path or LED name
  unsigned offset = 0;  // of kChipLabel and kChipPath
};

Result<LedName> parse_led_name(std::string_view text);

}  // namespace zenith
