#pragma once
// Who sends on a virtual CAN interface of this kernel: the one that $ZENITH_TEST_CAN names, or
// another. Emulated boards have one (tests/hil); needs root to take it down and up.

#include <linux/can.h>

#include <string>

#include "platform/linux/unique_fd.h"

namespace zenith {

class CanSender {
 public:
  CanSender();
  explicit CanSender(std::string interface);

  // Why there is none; empty when there is.
  const std::string& missing() const { return missing_; }
  const std::string& interface() const { return interface_; }
  // Also error frames. A failure is a failure of the test.
  void send(const can_frame& frame);
  void set_up(bool up);

 private:
  void open();

  std::string interface_;
  std::string missing_;
  UniqueFd fd_;
};

}  // namespace zenith
