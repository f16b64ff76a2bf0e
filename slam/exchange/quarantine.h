#pragma once
// Faults of each robot, whatever its boot: three within a minute, and nothing of it is used for a
// minute; the next time for two, up to an hour. An hour without a fault forgives all.
// Full: the robot whose last fault is longest ago is forgotten, those in quarantine last of all.

#include <array>
#include <cstdint>

#include "platform/base/time.h"
#include "slam/capacity.h"

namespace zenith::exchange {

class Quarantine {
 public:
  // True: with this fault its quarantine begins.
  bool fault(Time now, std::uint64_t robot);
  bool holds(Time now, std::uint64_t robot) const;

 private:
  static constexpr std::size_t kFaults = 3;
  struct Offender {
    std::uint64_t robot = 0;
    bool used = false;
    std::array<Time, kFaults> faults = {};  // a ring
    std::size_t count = 0;                  // since the last quarantine
    Time last;
    Time until;
    Duration length;  // of the last quarantine; 0: there was none
  };
  const Offender* find(std::uint64_t robot) const;
  Offender& entry_of(Time now, std::uint64_t robot);

  std::array<Offender, kMaxReplicas> offenders_ = {};
};

}  // namespace zenith::exchange
