#include "slam/kernels/rows/rows.h"

#include "slam/kernels/isa_in_use.h"

namespace zenith {
namespace {

constexpr std::array<const RowTable*, kIsaCount> kTables = {
    &kRowsScalar,
#ifdef ZENITH_WITH_SSE41
    &kRowsSse41,
#else
    nullptr,
#endif
#ifdef ZENITH_WITH_AVX2
    &kRowsAvx2,
#else
    nullptr,
#endif
#ifdef ZENITH_WITH_AVX512
    &kRowsAvx512,
#else
    nullptr,
#endif
#ifdef ZENITH_WITH_NEON
    &kRowsNeon,
#else
    nullptr,
#endif
    nullptr,
};

}  // namespace

const RowTable& row_table(Isa isa) {
  return table_for(kTables, isa);
}

const RowTable& rows_in_use() {
  return row_table(isa_in_use());
}

}  // namespace zenith
