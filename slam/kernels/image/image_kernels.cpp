#include "slam/kernels/image/image_kernels.h"

#include "slam/kernels/tables.h"

namespace zenith {
namespace {

constexpr std::array<const ImageTable*, kIsaCount> kTables = ZENITH_TABLES_WITHOUT_DOTPROD(kImage);

}  // namespace

const ImageTable& image_table(Isa isa) {
  return table_for(kTables, isa);
}

const ImageTable& image_kernels() {
  return image_table(isa_in_use());
}

}  // namespace zenith
