#include "slam/kernels/rows/rows.h"

#include "slam/kernels/tables.h"

namespace zenith {
namespace {

constexpr std::array<const RowTable*, kIsaCount> kTables = ZENITH_TABLES_WITHOUT_DOTPROD(kRows);

}  // namespace

const RowTable& row_table(Isa isa) {
  return table_for(kTables, isa);
}

const RowTable& rows_in_use() {
  return row_table(isa_in_use());
}

}  // namespace zenith
