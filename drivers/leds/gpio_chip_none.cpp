// Built without libgpiod.

#include "drivers/leds/gpio_chip.h"

namespace zenith {
namespace {

Error without_library() {
  return {
      "GPIO lines need libgpiod, and this program was built without it; build it with "
      "libgpiod-dev installed, or name LEDs of the kernel (led:NAME)"};
}

}  // namespace

std::string gpio_library() {
  return "none: built without libgpiod";
}

Result<GpioChipInfo> read_gpio_chip(const std::string&) {
  return without_library();
}

Result<std::unique_ptr<GpioOutput>> request_gpio_output(const GpioPlace&, bool,
                                                        const std::string&) {
  return without_library();
}

}  // namespace zenith
