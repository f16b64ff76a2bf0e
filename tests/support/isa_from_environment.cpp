// Tests and benchmarks run the kernels that ZENITH_SIMD names, or the best that the processor has.

#include <cstdio>
#include <cstdlib>

#include "platform/linux/cpu.h"
#include "slam/kernels/isa_in_use.h"

namespace zenith {
namespace {

const bool kChosen = [] {
  const auto isa = choose_isa(std::getenv("ZENITH_SIMD"));
  if (!isa) {
    std::fprintf(stderr, "%s\n", isa.error().message.c_str());
    std::exit(2);
  }
  use_isa(*isa);
  return true;
}();

}  // namespace
}  // namespace zenith
