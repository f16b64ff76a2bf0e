#include "slam/kernels/isa_in_use.h"

namespace zenith {
namespace {

Isa in_use = Isa::kScalar;

}  // namespace

Isa isa_in_use() {
  return in_use;
}

void use_isa(Isa isa) {
  in_use = isa;
}

}  // namespace zenith
