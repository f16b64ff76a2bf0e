#ifdef ZENITH_WITH_NEON
#include <arm_neon.h>

#include "slam/kernels/image/image_body.h"

namespace zenith {
namespace {

struct Neon : LoadsOneByOne {
  static constexpr int kLanes = 4;
  static ZENITH_INLINE unsigned bits(const Ints<4>& mask) { return bits_of(mask); }
  // Here all halves are below 2^15 and above -1.
  static ZENITH_INLINE Ints<4> madd(const Ints<4>& a, const Ints<4>& b) {
    return (a & 0xffff) * (b & 0xffff) + (a >> 16) * (b >> 16);
  }
};

}  // namespace

const ImageTable kImageNeon = ImageKernels<Neon>::table(Isa::kNeon);

}  // namespace zenith
#endif
