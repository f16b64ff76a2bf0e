#include "drivers/leds/gpiod_leds.h"

namespace zenith {

Status GpiodLed::open() {
  close();
  std::string why_none;
  const std::vector<GpioChipInfo> chips = list_gpio_chips(&why_none);
  Result<GpioPlace> place = find_gpio_line(name_, chips);
  if (!place.ok()) {
    if (why_none.empty()) return place.error();
    return Error{place.error().message + " (" + why_none + ")"};
  }
  Result<std::unique_ptr<GpioOutput>> output = request_gpio_output(*place, active_low_, "zenith");
  if (!output.ok()) return output.error();
  place_ = std::move(*place);
  output_ = std::move(*output);
  return {};
}

Status GpiodLed::set(bool lit) {
  return output_ == nullptr ? Status() : output_->set(lit);
}

std::string GpiodLed::description() const {
  std::string text = "GPIO line ";
  text += name_.kind == LedKind::kLineName ? name_.text
                                           : name_.text + ":" + std::to_string(name_.offset);
  if (output_ != nullptr)
    text += " (" + place_.chip_path + ":" + std::to_string(place_.offset) + ")";
  return text + (active_low_ ? ", active low" : "");
}

}  // namespace zenith
