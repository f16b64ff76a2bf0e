#ifdef ZENITH_WITH_AVX2
#include "slam/kernels/rows/rows_body.h"

namespace zenith {

const RowTable kRowsAvx2 = RowKernels<8, 8, 4>::table(Isa::kAvx2);

}  // namespace zenith
#endif
