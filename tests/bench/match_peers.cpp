#include "tests/bench/match_peers.h"

#include <algorithm>

#include "platform/linux/cpu.h"
#include "slam/kernels/match/match_two_best.h"
#ifdef ZENITH_WITH_OPENBLAS
#include <cblas.h>
#endif

namespace zenith::bench {

extern const GemmPeer kEigenSse2;
#ifdef __x86_64__
extern const GemmPeer kEigenAvx2;
extern const GemmPeer kEigenAvx512;
#endif

namespace {

#ifdef ZENITH_WITH_OPENBLAS
void multiply_openblas(const float* looks, int look_count, const float* queries, int query_count,
                       int length, float* products) {
  cblas_sgemm(CblasColMajor, CblasTrans, CblasNoTrans, look_count, query_count, length, 1.0F, looks,
              length, queries, length, 0.0F, products, look_count);
}
#endif

}  // namespace

std::vector<GemmPeer> gemm_peers() {
  std::vector<GemmPeer> peers = {kEigenSse2};
#ifdef __x86_64__
  if (cpu_has(Isa::kAvx2)) peers.push_back(kEigenAvx2);
  if (cpu_has(Isa::kAvx512)) peers.push_back(kEigenAvx512);
#endif
#ifdef ZENITH_WITH_OPENBLAS
  openblas_set_num_threads(1);
  peers.push_back({"openblas", multiply_openblas, peers.back().largest});
#endif
  return peers;
}

void gemm_two_best(const GemmPeer& peer, int length, const std::vector<float>& looks,
                   const std::vector<float>& queries, std::span<const std::int32_t> landmarks,
                   std::vector<float>& products, std::vector<TwoBest>& found) {
  const int look_count = static_cast<int>(landmarks.size());
  const int query_count = static_cast<int>(found.size());
  for (int begin = 0; begin < look_count; begin += kGemmBlock) {
    const int count = std::min(kGemmBlock, look_count - begin);
    peer.multiply(looks.data() + static_cast<std::ptrdiff_t>(begin) * length, count, queries.data(),
                  query_count, length, products.data());
    for (int q = 0; q < query_count; ++q) {
      TwoBest& best = found[static_cast<std::size_t>(q)];
      const float* column = products.data() + static_cast<std::ptrdiff_t>(q) * count;
      if (peer.largest(column, count) <= best.second.ncc) continue;
      for (int i = 0; i < count; ++i) {
        if (column[i] <= best.second.ncc) continue;
        take_if_better(q, begin + i, landmarks[static_cast<std::size_t>(begin + i)], column[i],
                       best);
      }
    }
  }
}

}  // namespace zenith::bench
