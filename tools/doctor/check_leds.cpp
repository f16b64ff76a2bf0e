#include "tools/doctor/check_leds.h"

#include <unistd.h>

#include <algorithm>

namespace zenith::tools {
namespace {

constexpr const char* kConsumer = "zenith";  // as the driver names itself
constexpr const char* kNames[kLedCount] = {"led status", "led peer", "led fault"};

Finding check_class_led(const std::string& what, const LedName& name, const MachineFiles& files) {
  const std::string folder = "/sys/class/leds";
  const std::string file = folder + "/" + name.text + "/brightness";
  if (!files.exists(file)) {
    std::string known;
    for (const std::string& led : files.list(folder)) known += (known.empty() ? "" : ", ") + led;
    return fail(what,
                file + " is not there; LEDs of this kernel: " + (known.empty() ? "none" : known),
                "name one of them, or leave it out", "ls /sys/class/leds");
  }
  if (::access(files.at(file).c_str(), W_OK) == 0) return ok(what, file + " can be written");
  return warn(what, file + " cannot be written by this user",
              "give the service's group write access by a udev rule");
}

Finding check_gpio_led(const std::string& what, const LedName& name,
                       const std::vector<GpioChipInfo>& chips, const std::string& why_no_chips) {
  if (chips.empty()) {
    return fail(what, why_no_chips, "give the user the GPIO chips, or leave the light out",
                "ls -l /dev/gpiochip*");
  }
  const auto place = find_gpio_line(name, chips);
  if (!place) return fail(what, place.error().message, "correct its name", "gpioinfo");
  const auto chip = std::find_if(chips.begin(), chips.end(),
                                 [&](const GpioChipInfo& c) { return c.path == place->chip_path; });
  const GpioLineInfo& line = chip->lines[place->offset];
  const std::string found = chip->path + " line " + std::to_string(place->offset) +
                            (line.name.empty() ? "" : " (" + line.name + ")");
  if (!line.used) return ok(what, found + ", free");
  if (line.consumer == kConsumer) return ok(what, found + ", held by zenithd");
  return fail(what, found + ", held by '" + line.consumer + "'",
              "take it from that program or driver, or name another line", "gpioinfo");
}

}  // namespace

Findings check_leds(const LedSettings& settings, const std::vector<GpioChipInfo>& chips,
                    const std::string& why_no_chips, const MachineFiles& files) {
  Findings findings;
  for (std::size_t i = 0; i < settings.leds.size(); ++i) {
    const auto name = parse_led_name(settings.leds[i].name);
    if (!name) {
      findings.push_back(fail(kNames[i], name.error().message, "correct it"));
    } else if (name->kind == LedKind::kLedClass) {
      findings.push_back(check_class_led(kNames[i], *name, files));
    } else if (name->kind != LedKind::kNone) {
      findings.push_back(check_gpio_led(kNames[i], *name, chips, why_no_chips));
    }
  }
  if (findings.empty()) findings.push_back(skip("leds", "[leds] names none"));
  return findings;
}

}  // namespace zenith::tools
