#pragma once
// The instruction set that kernels use. Set once, before the first step; scalar until then.
//
// It changes how fast a result comes, not the result: integer kernels give the same bits on every
// path, and float kernels do the same operations in the same order, without fused multiply-adds.
// On 32-bit ARM the compiler takes lanes of floats one by one, for the sake of the same bits.

#include "platform/base/isa.h"

namespace zenith {

Isa isa_in_use();

// The processor must have it: see platform/linux/cpu.h. Not while a step runs.
void use_isa(Isa isa);

// A kernel's table for `isa`, or for the best one below it that it is written for. `tables` is
// indexed by Isa, null where there is none, and always has the scalar one.
template <typename Table>
const Table& table_for(const std::array<const Table*, kIsaCount>& tables, Isa isa) {
  while (tables[static_cast<std::size_t>(isa)] == nullptr) isa = isa_below(isa);
  return *tables[static_cast<std::size_t>(isa)];
}

}  // namespace zenith
