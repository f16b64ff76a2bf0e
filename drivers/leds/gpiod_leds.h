#pragma once
// LEDs on GPIO lines.

#include <memory>
#include <string>

#include "drivers/leds/gpio_chip.h"
#include "drivers/leds/led_group.h"

namespace zenith {

class GpiodLed : public Led {
 public:
  GpiodLed(LedName name, bool active_low) : name_(std::move(name)), active_low_(active_low) {}

  // Looks for the line anew each time: chips change their numbers, and come late.
  Status open() override;
  void close() override { output_.reset(); }
  Status set(bool lit) override;
  std::string description() const override;

 private:
  const LedName name_;
  const bool active_low_;
  GpioPlace place_;  // while open
  std::unique_ptr<GpioOutput> output_;
};

}  // namespace zenith
