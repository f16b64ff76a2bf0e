#pragma once
// Checks of the robot's lights: GPIO lines by name found and free, LEDs of the kernel writable.

#include <string>
#include <vector>

#include "drivers/leds/gpio_chip.h"
#include "drivers/leds/led_name.h"
#include "tools/doctor/finding.h"
#include "tools/doctor/machine_files.h"

namespace zenith::tools {

// One finding for each LED that is named, or one for none.
Findings check_leds(const LedSettings& settings, const std::vector<GpioChipInfo>& chips,
                    const std::string& why_no_chips, const MachineFiles& files);

}  // namespace zenith::tools
