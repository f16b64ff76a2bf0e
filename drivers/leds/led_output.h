#pragma once
// The LEDs of a robot, whatever they hang on. For a thread without deadlines: calls allocate and
// talk to the kernel. One thread at a time.
//
// LEDs are never worth a robot's life: an open() that fails is a warning; go on, try again later.

#include <memory>
#include <string>

#include "drivers/leds/led_name.h"
#include "drivers/leds/led_pattern.h"
#include "platform/base/result.h"

namespace zenith {

class LedOutput {
 public:
  LedOutput() = default;
  LedOutput(const LedOutput&) = delete;
  LedOutput& operator=(const LedOutput&) = delete;
  virtual ~LedOutput() = default;

  // Takes the LEDs and turns them off. The error says what was looked for, what is there and what
  // to do. Closes first when it is open already. All LEDs or none.
  virtual Status open() = 0;
  // Turns the LEDs off and gives them back as they were found.
  virtual void close() = 0;
  virtual bool is_open() const = 0;

  // Lights these, the others not. After an error the LEDs are closed: open() again, some time
  // later. Without effect while closed.
  virtual Status set(LedMask lit) = 0;

  // For a person: "GPIO line STATUS (gpio-sim, 3), LED led0".
  virtual std::string description() const = 0;
};

// A robot without LEDs.
class NullLeds : public LedOutput {
 public:
  Status open() override {
    open_ = true;
    return {};
  }
  void close() override { open_ = false; }
  bool is_open() const override { return open_; }
  Status set(LedMask) override { return {}; }
  std::string description() const override { return "no LEDs"; }

 private:
  bool open_ = false;
};

// Not opened yet. An error is a mistake in the settings; it names all of them. That a named LED is
// not there shows in open().
Result<std::unique_ptr<LedOutput>> make_led_output(const LedSettings& settings);

}  // namespace zenith
