#ifdef ZENITH_WITH_AVX512
#include <immintrin.h>

#include "slam/kernels/image/image_body.h"

namespace zenith {
namespace {

struct Avx512 {
  static constexpr int kLanes = 16;
  static ZENITH_INLINE unsigned bits(const Ints<16>& mask) {
    return _mm512_movepi32_mask(reinterpret_cast<__m512i>(mask));
  }
  static ZENITH_INLINE Ints<16> madd(const Ints<16>& a, const Ints<16>& b) {
    return reinterpret_cast<Ints<16>>(
        _mm512_madd_epi16(reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b)));
  }
  static ZENITH_INLINE Shorts<16> shorts(const std::uint8_t* from) {
    return reinterpret_cast<Shorts<16>>(
        _mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from))));
  }
  static ZENITH_INLINE Ints<16> ints(const Shorts<16>& s) {
    return reinterpret_cast<Ints<16>>(
        _mm512_maskz_cvtepi16_epi32(0xffff, reinterpret_cast<__m256i>(s)));
  }
  static ZENITH_INLINE Ints<16> gather(const std::uint8_t* base, const Ints<16>& offsets) {
    // With all lanes asked for, what the destination held before does not matter.
    return reinterpret_cast<Ints<16>>(_mm512_mask_i32gather_epi32(
        _mm512_setzero_si512(), 0xffff, reinterpret_cast<__m512i>(offsets), base, 1));
  }
  static ZENITH_INLINE void deinterleave(const RemapEntry* entries, Ints<16>& uv,
                                         Ints<16>& weights) {
    Ints<16> low;
    Ints<16> high;
    __builtin_memcpy(&low, entries, sizeof(low));
    __builtin_memcpy(&high, entries + 8, sizeof(high));
    uv = __builtin_shufflevector(low, high, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28,
                                 30);
    weights = __builtin_shufflevector(low, high, 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27,
                                      29, 31);
  }
};

}  // namespace

const ImageTable kImageAvx512 = ImageKernels<Avx512>::table(Isa::kAvx512);

}  // namespace zenith
#endif
