#pragma once
// Every CAN bus with somebody at its other end, for the contract that all of them keep.

#include <memory>
#include <string>
#include <vector>

#include "drivers/odometry/can_bus.h"

namespace zenith {

class CanBusRig {
 public:
  CanBusRig() = default;
  CanBusRig(const CanBusRig&) = delete;
  CanBusRig& operator=(const CanBusRig&) = delete;
  virtual ~CanBusRig() = default;

  // Why the rig cannot be built here; empty when it can.
  virtual std::string missing() const { return ""; }
  // The bus, not open yet, on which `frames` (whose stamps do not matter) will be sent.
  virtual std::unique_ptr<CanBus> make(const CanIds& ids, const std::vector<CanFrame>& frames) = 0;
  // The bus is open: sends the frames. A recording plays by itself.
  virtual void send() = 0;
  // The moment is over at which a recording begins to play; the next one that is made plays later.
  virtual bool plays_already() const { return false; }
  // The clock of stamps and timeouts.
  virtual Time now() const = 0;

  // Buses that can fail.
  virtual bool can_fail() const { return true; }
  virtual void set_up(bool up) = 0;
  virtual void set_bus_off(bool off) = 0;
};

struct NamedRig {
  const char* name;
  std::unique_ptr<CanBusRig> (*make)();
};

// The SocketCAN bus on a kernel in memory, the simulated bus, the replayed one, and the SocketCAN
// bus on the interface that $ZENITH_TEST_CAN names (a virtual one; root).
const std::vector<NamedRig>& can_bus_rigs();

}  // namespace zenith
