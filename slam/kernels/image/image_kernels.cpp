#include "slam/kernels/image/image_kernels.h"

#include "slam/kernels/isa_in_use.h"

namespace zenith {
namespace {

constexpr std::array<const ImageTable*, kIsaCount> kTables = {
    &kImageScalar,
#ifdef ZENITH_WITH_SSE41
    &kImageSse41,
#else
    nullptr,
#endif
#ifdef ZENITH_WITH_AVX2
    &kImageAvx2,
#else
    nullptr,
#endif
#ifdef ZENITH_WITH_AVX512
    &kImageAvx512,
#else
    nullptr,
#endif
#ifdef ZENITH_WITH_NEON
    &kImageNeon,
#else
    nullptr,
#endif
    nullptr,
};

}  // namespace

const ImageTable& image_table(Isa isa) {
  return table_for(kTables, isa);
}

const ImageTable& image_kernels() {
  return image_table(isa_in_use());
}

}  // namespace zenith
