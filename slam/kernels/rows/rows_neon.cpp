#ifdef ZENITH_WITH_NEON
#include "slam/kernels/rows/rows_body.h"

namespace zenith {

const RowTable kRowsNeon = RowKernels<4, 4, 2>::table(Isa::kNeon);

}  // namespace zenith
#endif
