#ifdef ZENITH_WITH_SSE41
#include <immintrin.h>

#include "slam/kernels/image/image_body.h"

namespace zenith {
namespace {

struct Sse41 : LoadsOneByOne {
  static constexpr int kLanes = 4;
  static ZENITH_INLINE unsigned bits(const Ints<4>& mask) {
    return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(mask)));
  }
  static ZENITH_INLINE Ints<4> madd(const Ints<4>& a, const Ints<4>& b) {
    return reinterpret_cast<Ints<4>>(
        _mm_madd_epi16(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
  }
};

}  // namespace

const ImageTable kImageSse41 = ImageKernels<Sse41>::table(Isa::kSse41);

}  // namespace zenith
#endif
