#pragma once
// What one would build for matching: products of float matrices by Eigen (compiled for SSE2, AVX2
// with fused multiply-adds, AVX-512) and OpenBLAS (where it is installed; it chooses by itself).

#include <cstdint>
#include <span>
#include <vector>

#include "slam/kernels/match/match.h"

namespace zenith::bench {

inline constexpr int kGemmBlock = 512;  // looks at a time: their products stay in the cache

struct GemmPeer {
  const char* name;
  // products(look_count x query_count) = looks' * queries; all of them column for column, a patch
  // each.
  void (*multiply)(const float* looks, int look_count, const float* queries, int query_count,
                   int length, float* products);
  float (*largest)(const float* values, int count);
};

// Those that this processor can run.
std::vector<GemmPeer> gemm_peers();

// The kernels' two_best() by such products: a column without anything better is left at its
// maximum.
void gemm_two_best(const GemmPeer& peer, int length, const std::vector<float>& looks,
                   const std::vector<float>& queries, std::span<const std::int32_t> landmarks,
                   std::vector<float>& products, std::vector<TwoBest>& found);

}  // namespace zenith::bench
