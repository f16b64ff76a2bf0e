#ifdef ZENITH_WITH_SSE41
#include "slam/kernels/rows/rows_body.h"

namespace zenith {

const RowTable kRowsSse41 = RowKernels<4, 4, 2>::table(Isa::kSse41);

}  // namespace zenith
#endif
