#pragma once

#include <string>

#include "drivers/leds/gpio_chip.h"

namespace zenith {

// What every version of libgpiod leaves in errno, for a person.
Error gpio_chip_error(const std::string& path, int error);
Error gpio_line_error(const GpioPlace& place, int error);

}  // namespace zenith
