#pragma once
// The instruction sets that a kernel's test forces, one after the other.

#include <vector>

#include "platform/linux/cpu.h"

namespace zenith {

inline std::vector<Isa> isas_here() {
  std::vector<Isa> isas;
  for (int i = 0; i < kIsaCount; ++i) {
    if (cpu_has(static_cast<Isa>(i))) isas.push_back(static_cast<Isa>(i));
  }
  return isas;
}

}  // namespace zenith
