#pragma once
// Faults of each sender: three within a minute, and nothing of it is used for a minute; the next
// time for two, up to an hour. An hour without a fault forgives all. A robot's next boot, and the
// same one with another key of the fleet, is another sender: who takes a robot's name makes faults
// of its own, not of the robot.
// Full: the sender whose last fault is longest ago is forgotten, those in quarantine last of all.

#include <array>
#include <cstdint>

#include "platform/base/time.h"
#include "slam/capacity.h"
#include "slam/exchange/interface.h"

namespace zenith::exchange {

class Quarantine {
 public:
  // True: with this fault its quarantine begins.
  bool fault(Time now, const Sender& sender);
  bool holds(Time now, const Sender& sender) const;

 private:
  static constexpr std::size_t kFaults = 3;
  struct Offender {
    Sender sender;
    bool used = false;
    std::array<Time, kFaults> faults = {};  // a ring
    std::size_t count = 0;                  // since the last quarantine
    Time last;
    Time until;
    Duration length;  // of the last quarantine; 0: there was none
  };
  const Offender* find(const Sender& sender) const;
  Offender& entry_of(Time now, const Sender& sender);

  std::array<Offender, kMaxReplicas> offenders_ = {};
};

}  // namespace zenith::exchange
