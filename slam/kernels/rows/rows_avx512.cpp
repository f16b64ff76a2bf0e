#ifdef ZENITH_WITH_AVX512
#include "slam/kernels/rows/rows_body.h"

namespace zenith {

const RowTable kRowsAvx512 = RowKernels<16, 8, 8>::table(Isa::kAvx512);

}  // namespace zenith
#endif
