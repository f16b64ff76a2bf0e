#include "drivers/leds/led_name.h"

#include <charconv>

namespace zenith {
namespace {

bool take_prefix(std::string_view& text, std::string_view prefix) {
  if (text.substr(0, prefix.size()) != prefix) return false;
  text.remove_prefix(prefix.size());
  return true;
}

Error bad_name(std::string_view whole, const std::string& why) {
  return {"\"" + std::string(whole) + "\" names no LED: " + why +
          "; expected gpio:NAME, gpiochip-label:LABEL:OFFSET, gpiochip:/dev/gpiochipN:OFFSET, "
          "led:NAME, or nothing. `gpioinfo` and /sys/class/leds say what this board has"};
}

// "chip:7": the last colon parts them, for labels may hold colons.
Result<LedName> parse_chip(std::string_view whole, std::string_view rest, LedKind kind) {
  const std::size_t colon = rest.rfind(':');
  if (colon == std::string_view::npos || colon == 0) {
    return bad_name(whole, "chip or offset is missing");
  }
  LedName name;
  name.kind = kind;
  name.text = rest.substr(0, colon);
  const std::string_view digits = rest.substr(colon + 1);
  const char* end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, name.offset);
  if (error != std::errc() || stop != end) {
    return bad_name(whole, "\"" + std::string(digits) + "\" is no offset");
  }
  return name;
}

}  // namespace

Result<LedName> parse_led_name(std::string_view text) {
  if (text.empty()) return LedName{};
  std::string_view rest = text;
  if (take_prefix(rest, "gpio:")) {
    if (rest.empty()) return bad_name(text, "the line's name is missing");
    return LedName{LedKind::kLineName, std::string(rest), 0};
  }
  if (take_prefix(rest, "gpiochip-label:")) return parse_chip(text, rest, LedKind::kChipLabel);
  if (take_prefix(rest, "gpiochip:")) {
    if (rest.substr(0, 1) != "/") return bad_name(text, "the chip is no path");
    return parse_chip(text, rest, LedKind::kChipPath);
  }
  if (take_prefix(rest, "led:")) {
    if (rest.empty()) return bad_name(text, "the LED's name is missing");
    if (rest.find('/') != std::string_view::npos || rest[0] == '.') {
      return bad_name(text, "it is the name of a folder in /sys/class/leds, without slashes");
    }
    return LedName{LedKind::kLedClass, std::string(rest), 0};
  }
  return bad_name(text, "unknown kind");
}

}  // namespace zenith
