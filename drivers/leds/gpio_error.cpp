#include "drivers/leds/gpio_error.h"

#include <cerrno>

#include "platform/linux/errno_text.h"

namespace zenith {

Error gpio_chip_error(const std::string& path, int error) {
  std::string message = "GPIO chip " + path + ": " + errno_text(error);
  if (error == EACCES || error == EPERM) {
    message +=
        "; give the service's group access to it (udev rule), and allow it in the unit "
        "(DeviceAllow=)";
  }
  return {message};
}

Error gpio_line_error(const GpioPlace& place, int error) {
  std::string message = "GPIO line " + std::to_string(place.offset) + " of " + place.chip_path +
                        ": " + errno_text(error);
  if (error == EBUSY) {
    message +=
        "; somebody else holds it: `gpioinfo` tells who. An LED that the kernel holds is "
        "named led:NAME";
  }
  return {message};
}

}  // namespace zenith
