#pragma once
// The processor's instruction sets, and the one that kernels are to use.

#include "platform/base/isa.h"
#include "platform/base/result.h"

namespace zenith {

// Whether processor and kernel run code of this instruction set.
bool cpu_has(Isa isa);

// The best that the processor has.
Isa best_isa();

// `wanted` (the value of ZENITH_SIMD, such as "avx2"), or the best for null and "". An error for an
// unknown name and for what this processor lacks.
Result<Isa> choose_isa(const char* wanted);

}  // namespace zenith
