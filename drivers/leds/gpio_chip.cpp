#include "drivers/leds/gpio_chip.h"

#include <dirent.h>

#include <algorithm>
#include <cassert>
#include <string_view>

namespace zenith {
namespace {

constexpr const char kDevices[] = "/dev";
constexpr std::string_view kChipPrefix = "gpiochip";

std::vector<std::string> chip_paths() {
  std::vector<std::string> paths;
  if (DIR* dir = ::opendir(kDevices)) {
    while (const dirent* entry = ::readdir(dir)) {
      const std::string_view name = entry->d_name;
      if (name.substr(0, kChipPrefix.size()) != kChipPrefix) continue;
      paths.push_back(std::string(kDevices) + "/" + entry->d_name);
    }
    ::closedir(dir);
  }
  // gpiochip2 before gpiochip10.
  std::sort(paths.begin(), paths.end(), [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  });
  return paths;
}

std::string labels_of(const std::vector<GpioChipInfo>& chips) {
  std::string text;
  for (const GpioChipInfo& chip : chips) {
    text += (text.empty() ? "" : ", ") + chip.path + " (" + chip.label + ", " +
            std::to_string(chip.lines.size()) + " lines)";
  }
  return text.empty() ? "none" : text;
}

std::string what(const LedName& name) {
  switch (name.kind) {
    case LedKind::kLineName:
      return "a GPIO line with the name \"" + name.text + "\"";
    case LedKind::kChipLabel:
      return "line " + std::to_string(name.offset) + " of the GPIO chip with the label \"" +
             name.text + "\"";
    default:
      return "line " + std::to_string(name.offset) + " of the GPIO chip " + name.text;
  }
}

// The line's offset in this chip that the name may mean; nothing when it is not there.
std::vector<GpioPlace> places_in(const GpioChipInfo& chip, const LedName& name) {
  std::vector<GpioPlace> places;
  if (name.kind == LedKind::kLineName) {
    for (std::size_t i = 0; i < chip.lines.size(); ++i) {
      if (chip.lines[i].name == name.text) {
        places.push_back({chip.path, static_cast<unsigned>(i)});
      }
    }
    return places;
  }
  const std::string& own = name.kind == LedKind::kChipLabel ? chip.label : chip.path;
  if (own == name.text && name.offset < chip.lines.size())
    places.push_back({chip.path, name.offset});
  return places;
}

}  // namespace

std::vector<GpioChipInfo> list_gpio_chips(std::string* why_none) {
  std::vector<GpioChipInfo> chips;
  std::string why = "this board has no /dev/gpiochip*";
  for (const std::string& path : chip_paths()) {
    Result<GpioChipInfo> chip = read_gpio_chip(path);
    if (chip.ok()) {
      chips.push_back(std::move(*chip));
    } else {
      why = chip.error().message;
    }
  }
  if (why_none != nullptr && chips.empty()) *why_none = why;
  return chips;
}

Result<GpioPlace> find_gpio_line(const LedName& name, const std::vector<GpioChipInfo>& chips) {
  assert(name.kind != LedKind::kNone && name.kind != LedKind::kLedClass);
  std::vector<GpioPlace> places;
  for (const GpioChipInfo& chip : chips) {
    for (GpioPlace& place : places_in(chip, name)) places.push_back(std::move(place));
  }
  if (places.size() == 1) return places[0];
  if (places.empty()) {
    return Error{"expected " + what(name) + ", found no such line; chips of this board: " +
                 labels_of(chips) + "; `gpioinfo` lists their lines"};
  }
  std::string found;
  for (const GpioPlace& place : places) {
    found += (found.empty() ? "" : ", ") + place.chip_path + ":" + std::to_string(place.offset);
  }
  return Error{"expected one " + what(name).substr(name.kind == LedKind::kLineName ? 2 : 0) +
               ", found several: " + found + "; name one of them as gpiochip:" +
               places[0].chip_path + ":" + std::to_string(places[0].offset)};
}

}  // namespace zenith
