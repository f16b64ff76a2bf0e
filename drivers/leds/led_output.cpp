#include "drivers/leds/led_output.h"

#include <algorithm>

#include "drivers/leds/class_leds.h"
#include "drivers/leds/gpiod_leds.h"
#include "drivers/leds/led_group.h"

namespace zenith {
namespace {

// A null pointer: there is none.
Result<std::unique_ptr<Led>> make_led(const LedSetting& setting) {
  const Result<LedName> name = parse_led_name(setting.name);
  if (!name.ok()) return name.error();
  switch (name->kind) {
    case LedKind::kNone:
      return std::unique_ptr<Led>();
    case LedKind::kLedClass:
      if (setting.active_low) {
        return Error{"\"" + setting.name +
                     "\" is an LED of the kernel, which knows its polarity: leave active_low out"};
      }
      return std::unique_ptr<Led>(new ClassLed(name->text));
    default:
      return std::unique_ptr<Led>(new GpiodLed(*name, setting.active_low));
  }
}

// Whether an earlier LED has the same name: only one can have it.
bool named_before(const LedSettings& settings, std::size_t i) {
  const auto& leds = settings.leds;
  return !leds[i].name.empty() && std::any_of(leds.begin(), leds.begin() + i, [&](const auto& led) {
    return led.name == leds[i].name;
  });
}

}  // namespace

Result<std::unique_ptr<LedOutput>> make_led_output(const LedSettings& settings) {
  std::array<std::unique_ptr<Led>, kLedCount> leds;
  std::string mistakes;
  bool any = false;
  const auto add_mistake = [&mistakes](const std::string& text) {
    mistakes += (mistakes.empty() ? "" : "\n") + text;
  };
  for (std::size_t i = 0; i < leds.size(); ++i) {
    if (named_before(settings, i)) {
      add_mistake("\"" + settings.leds[i].name + "\" is named for two LEDs; name it for one");
      continue;
    }
    Result<std::unique_ptr<Led>> led = make_led(settings.leds[i]);
    if (led.ok()) {
      leds[i] = std::move(*led);
      any = any || leds[i] != nullptr;
    } else {
      add_mistake(led.error().message);
    }
  }
  if (!mistakes.empty()) return Error{mistakes};
  if (!any) return std::unique_ptr<LedOutput>(new NullLeds());
  return std::unique_ptr<LedOutput>(new LedGroup(std::move(leds)));
}

}  // namespace zenith
