#pragma once
// LEDs of several kinds as one output.

#include <array>
#include <memory>

#include "drivers/leds/led_output.h"

namespace zenith {

// One LED: the same calls as LedOutput's, for one.
class Led {
 public:
  Led() = default;
  Led(const Led&) = delete;
  Led& operator=(const Led&) = delete;
  virtual ~Led() = default;

  virtual Status open() = 0;  // off
  virtual void close() = 0;   // off, and given back
  virtual Status set(bool lit) = 0;
  virtual std::string description() const = 0;
};

class LedGroup : public LedOutput {
 public:
  // A null pointer: this LED is not there.
  explicit LedGroup(std::array<std::unique_ptr<Led>, kLedCount> leds) : leds_(std::move(leds)) {}
  ~LedGroup() override { LedGroup::close(); }

  Status open() override;
  void close() override;
  bool is_open() const override { return open_; }
  Status set(LedMask lit) override;
  std::string description() const override;

 private:
  std::array<std::unique_ptr<Led>, kLedCount> leds_;
  LedMask lit_ = 0;
  bool open_ = false;
};

}  // namespace zenith
