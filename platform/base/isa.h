#pragma once
// Instruction sets that kernels are written for (slam/kernels). Plain numbers: what the processor
// has is found out by platform/linux/cpu.h.

#include <array>
#include <optional>
#include <string_view>

namespace zenith {

enum class Isa {
  kScalar,
  kSse41,
  kAvx2,
  kAvx512,  // F, BW, VL and VNNI: Ice Lake and later, Zen 4 and later
  kNeon,
  kNeonDotprod,  // Cortex-A55, A76 and later; an illegal instruction on A53 and A72
};
inline constexpr int kIsaCount = 6;

inline constexpr std::array<std::string_view, kIsaCount> kIsaNames = {
    "scalar", "sse4.1", "avx2", "avx512", "neon", "neon-dotprod"};

constexpr std::string_view isa_name(Isa isa) {
  return kIsaNames[static_cast<std::size_t>(isa)];
}

constexpr std::optional<Isa> isa_named(std::string_view name) {
  for (std::size_t i = 0; i < kIsaNames.size(); ++i) {
    if (kIsaNames[i] == name) return static_cast<Isa>(i);
  }
  return {};
}

// What to fall back to where a kernel is not written for `isa`. kScalar has nothing below it.
constexpr Isa isa_below(Isa isa) {
  switch (isa) {
    case Isa::kAvx512:
      return Isa::kAvx2;
    case Isa::kAvx2:
      return Isa::kSse41;
    case Isa::kNeonDotprod:
      return Isa::kNeon;
    default:
      return Isa::kScalar;
  }
}

}  // namespace zenith
