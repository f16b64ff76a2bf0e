#include "slam/kernels/match/match.h"

#include "slam/kernels/isa_in_use.h"

namespace zenith {
namespace {

constexpr std::array<const MatchTable*, kIsaCount> kTables = {
    &kMatchScalar,
#ifdef ZENITH_WITH_SSE41
    &kMatchSse41,
#else
    nullptr,
#endif
#ifdef ZENITH_WITH_AVX2
    &kMatchAvx2,
#else
    nullptr,
#endif
#ifdef ZENITH_WITH_AVX512
    &kMatchAvx512,
#else
    nullptr,
#endif
#ifdef ZENITH_WITH_NEON
    &kMatchNeon,
#else
    nullptr,
#endif
#ifdef ZENITH_WITH_NEON_DOTPROD
    &kMatchNeonDotprod,
#else
    nullptr,
#endif
};

}  // namespace

const MatchTable& match_table(Isa isa) {
  return table_for(kTables, isa);
}

const MatchTable& match_in_use() {
  return match_table(isa_in_use());
}

}  // namespace zenith
