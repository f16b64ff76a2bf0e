#pragma once
// GPIO chips and output lines through libgpiod. One of three files implements this, chosen when the
// project is configured: gpio_chip_v1.cpp (libgpiod 1.x), gpio_chip_v2.cpp (2.x),
// gpio_chip_none.cpp.

#include <memory>
#include <string>
#include <vector>

#include "drivers/leds/led_name.h"
#include "platform/base/result.h"

namespace zenith {

struct GpioLineInfo {
  std::string name;      // empty: the board gives none
  std::string consumer;  // who holds it, when `used`
  bool used = false;
};

struct GpioChipInfo {
  std::string path;                 // "/dev/gpiochip0"
  std::string name;                 // "gpiochip0"
  std::string label;                // "pinctrl-bcm2711"
  std::vector<GpioLineInfo> lines;  // by offset
};

struct GpioPlace {
  std::string chip_path;
  unsigned offset = 0;
};

// A line that we drive. Its end turns it off and gives it back.
class GpioOutput {
 public:
  GpioOutput() = default;
  GpioOutput(const GpioOutput&) = delete;
  GpioOutput& operator=(const GpioOutput&) = delete;
  virtual ~GpioOutput() = default;

  virtual Status set(bool active) = 0;
};

// "libgpiod 1.6.3", "none: built without libgpiod".
std::string gpio_library();

Result<GpioChipInfo> read_gpio_chip(const std::string& path);

// Takes the line for `consumer`, off. Held by somebody else is an error.
Result<std::unique_ptr<GpioOutput>> request_gpio_output(const GpioPlace& place, bool active_low,
                                                        const std::string& consumer);

// All chips that can be read, in the order of their numbers. When none can, `why_none` (unless
// null) says why.
std::vector<GpioChipInfo> list_gpio_chips(std::string* why_none = nullptr);

// Where the line of this name lies. No such line, or several, is an error that says what there is.
// Not for an LED of the kernel.
Result<GpioPlace> find_gpio_line(const LedName& name, const std::vector<GpioChipInfo>& chips);

}  // namespace zenith
