#ifdef ZENITH_WITH_AVX2
#include <immintrin.h>

#include "slam/kernels/image/image_body.h"

namespace zenith {
namespace {

struct Avx2 {
  static constexpr int kLanes = 8;
  static ZENITH_INLINE unsigned bits(const Ints<8>& mask) {
    return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask)));
  }
  static ZENITH_INLINE Ints<8> madd(const Ints<8>& a, const Ints<8>& b) {
    return reinterpret_cast<Ints<8>>(
        _mm256_madd_epi16(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
  }
  static ZENITH_INLINE Shorts<8> shorts(const std::uint8_t* from) {
    return reinterpret_cast<Shorts<8>>(_mm_cvtepu8_epi16(_mm_loadu_si64(from)));
  }
  static ZENITH_INLINE Ints<8> ints(const Shorts<8>& s) {
    return reinterpret_cast<Ints<8>>(_mm256_cvtepi16_epi32(reinterpret_cast<__m128i>(s)));
  }
  static ZENITH_INLINE Ints<8> gather(const std::uint8_t* base, const Ints<8>& offsets) {
    return reinterpret_cast<Ints<8>>(_mm256_i32gather_epi32(reinterpret_cast<const int*>(base),
                                                            reinterpret_cast<__m256i>(offsets), 1));
  }
  static ZENITH_INLINE void deinterleave(const RemapEntry* entries, Ints<8>& uv, Ints<8>& weights) {
    Ints<8> low;
    Ints<8> high;
    __builtin_memcpy(&low, entries, sizeof(low));
    __builtin_memcpy(&high, entries + 4, sizeof(high));
    uv = __builtin_shufflevector(low, high, 0, 2, 4, 6, 8, 10, 12, 14);
    weights = __builtin_shufflevector(low, high, 1, 3, 5, 7, 9, 11, 13, 15);
  }
};

}  // namespace

const ImageTable kImageAvx2 = ImageKernels<Avx2>::table(Isa::kAvx2);

}  // namespace zenith
#endif
