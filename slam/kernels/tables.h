#pragma once
// A kernel's tables by Isa, for table_for(): ZENITH_TABLES(kMatch) names kMatchScalar, kMatchSse41
// and so on, and leaves out what the compiler does not build for. ZENITH_TABLES_WITHOUT_DOTPROD is
// for kernels that dot products bring nothing.

#include "slam/kernels/isa_in_use.h"

#ifdef ZENITH_WITH_SSE41
#define ZENITH_TABLE_SSE41(name) &name##Sse41
#else
#define ZENITH_TABLE_SSE41(name) nullptr
#endif
#ifdef ZENITH_WITH_AVX2
#define ZENITH_TABLE_AVX2(name) &name##Avx2
#else
#define ZENITH_TABLE_AVX2(name) nullptr
#endif
#ifdef ZENITH_WITH_AVX512
#define ZENITH_TABLE_AVX512(name) &name##Avx512
#else
#define ZENITH_TABLE_AVX512(name) nullptr
#endif
#ifdef ZENITH_WITH_NEON
#define ZENITH_TABLE_NEON(name) &name##Neon
#else
#define ZENITH_TABLE_NEON(name) nullptr
#endif
#ifdef ZENITH_WITH_NEON_DOTPROD
#define ZENITH_TABLE_NEON_DOTPROD(name) &name##NeonDotprod
#else
#define ZENITH_TABLE_NEON_DOTPROD(name) nullptr
#endif

// clang-format off
#define ZENITH_TABLES(name)                                                                    \
  {&name##Scalar, ZENITH_TABLE_SSE41(name), ZENITH_TABLE_AVX2(name),                           \
   ZENITH_TABLE_AVX512(name), ZENITH_TABLE_NEON(name), ZENITH_TABLE_NEON_DOTPROD(name)}
#define ZENITH_TABLES_WITHOUT_DOTPROD(name)                                                    \
  {&name##Scalar, ZENITH_TABLE_SSE41(name), ZENITH_TABLE_AVX2(name),                           \
   ZENITH_TABLE_AVX512(name), ZENITH_TABLE_NEON(name), nullptr}
// clang-format on
