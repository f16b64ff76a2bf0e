#include "slam/kernels/match/match.h"

#include "slam/kernels/tables.h"

namespace zenith {
namespace {

constexpr std::array<const MatchTable*, kIsaCount> kTables = ZENITH_TABLES(kMatch);

}  // namespace

const MatchTable& match_table(Isa isa) {
  return table_for(kTables, isa);
}

const MatchTable& match_in_use() {
  return match_table(isa_in_use());
}

}  // namespace zenith
