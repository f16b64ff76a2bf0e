#pragma once
// LEDs that the kernel drives (/sys/class/leds): the board's own ones, and those that the device
// tree declares. Polarity is the kernel's business.

#include <string>

#include "drivers/leds/led_group.h"
#include "platform/linux/unique_fd.h"

namespace zenith {

inline constexpr const char* kLedClassFolder = "/sys/class/leds";

class ClassLed : public Led {
 public:
  explicit ClassLed(std::string name, std::string class_folder = kLedClassFolder)
      : name_(std::move(name)), class_folder_(std::move(class_folder)) {}
  ~ClassLed() override { ClassLed::close(); }

  // Takes the LED from its trigger (such as the memory card's activity), which close() restores.
  Status open() override;
  void close() override;
  Status set(bool lit) override;
  std::string description() const override { return "LED " + name_; }

 private:
  std::string file(const char* attribute) const {
    return class_folder_ + "/" + name_ + "/" + attribute;
  }

  const std::string name_;
  const std::string class_folder_;
  UniqueFd brightness_;
  std::string full_ = "1";  // what max_brightness says
  std::string trigger_;     // to restore; empty: none
};

}  // namespace zenith
