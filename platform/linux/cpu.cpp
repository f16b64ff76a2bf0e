#include "platform/linux/cpu.h"

#if defined(__arm__) || defined(__aarch64__)
#include <asm/hwcap.h>
#include <sys/auxv.h>
#endif

#include <string>

namespace zenith {
namespace {

std::string names_of_this_cpu() {
  std::string names;
  for (int i = 0; i < kIsaCount; ++i) {
    const auto isa = static_cast<Isa>(i);
    if (!cpu_has(isa)) continue;
    if (!names.empty()) names += ", ";
    names += isa_name(isa);
  }
  return names;
}

}  // namespace

bool cpu_has(Isa isa) {
  if (isa == Isa::kScalar) return true;
#if defined(__x86_64__) || defined(__i386__)
  switch (isa) {
    case Isa::kSse41:
      return __builtin_cpu_supports("sse4.1") != 0;
    case Isa::kAvx2:
      return __builtin_cpu_supports("avx2") != 0;
    case Isa::kAvx512:
      return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
             __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0 &&
             __builtin_cpu_supports("avx512vnni") != 0;
    default:
      return false;
  }
#elif defined(__aarch64__)
  if (isa == Isa::kNeon) return true;
  return isa == Isa::kNeonDotprod && (getauxval(AT_HWCAP) & HWCAP_ASIMDDP) != 0;
#elif defined(__arm__)
  return isa == Isa::kNeon && (getauxval(AT_HWCAP) & HWCAP_NEON) != 0;
#else
  return false;
#endif
}

Isa best_isa() {
  for (const Isa isa : {Isa::kAvx512, Isa::kAvx2, Isa::kSse41, Isa::kNeonDotprod, Isa::kNeon}) {
    if (cpu_has(isa)) return isa;
  }
  return Isa::kScalar;
}

Result<Isa> choose_isa(const char* wanted) {
  if (wanted == nullptr || *wanted == '\0') return best_isa();
  const auto isa = isa_named(wanted);
  if (isa && cpu_has(*isa)) return *isa;
  return Error{"ZENITH_SIMD=" + std::string(wanted) +
               (isa ? ": this processor does not have it" : ": unknown instruction set") +
               "; it has " + names_of_this_cpu() + ". Without ZENITH_SIMD the best is taken."};
}

}  // namespace zenith
