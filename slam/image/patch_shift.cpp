#include "slam/image/patch_shift.h"

#include <array>
#include <cmath>

#include <Eigen/Cholesky>

namespace zenith {
namespace {

constexpr int kSide = kPatchSize;
constexpr int kLength = kSide * kSide;
constexpr float kReach_px = 3.0F;      // of the weights: one sigma
constexpr float kMostShift_px = 1.5F;  // beyond, one step from the centre is not near the peak
// What keeps shift, turn and contrast near zero where the patch does not tell them.
const Eigen::Vector4f kPrior(1e-6F, 1e-6F, 1e-5F, 1e-4F);

struct Weights {
  alignas(64) std::array<float, kLength> w = {};  // 0 on the rim, which has no gradient
  alignas(64) std::array<float, kLength> x = {};
  alignas(64) std::array<float, kLength> y = {};
  float sum = 0.0F;
};

Weights make_weights() {
  Weights out;
  for (int v = 1; v + 1 < kSide; ++v) {
    for (int u = 1; u + 1 < kSide; ++u) {
      const float x = static_cast<float>(u) - 0.5F * (kSide - 1);
      const float y = static_cast<float>(v) - 0.5F * (kSide - 1);
      const auto k = static_cast<std::size_t>(v * kSide + u);
      out.w[k] = std::exp(-0.5F * (x * x + y * y) / (kReach_px * kReach_px));
      out.sum += out.w[k];
      out.x[k] = x;
      out.y[k] = y;
    }
  }
  return out;
}

const Weights kWeights = make_weights();

}  // namespace

std::optional<Eigen::Vector2f> patch_shift(const Patch& look, const Patch& seen) {
  alignas(64) std::array<float, kLength> sum;         // of both, at unit norm
  alignas(64) std::array<float, kLength> difference;  // seen - look
  alignas(64) std::array<float, kLength> contrast;
  for (std::size_t k = 0; k < kLength; ++k) {
    const float a = look.inverse_norm * static_cast<float>(look.values[k]);
    const float b = seen.inverse_norm * static_cast<float>(seen.values[k]);
    sum[k] = a + b;
    difference[k] = b - a;
    contrast[k] = a;
  }
  // 10 of the normal matrix's upper half by rows, 4 of the right side, 5 for the means.
  constexpr int kSums = 19;
  std::array<std::array<float, kSide>, kSums> sums = {};  // by column
  for (std::size_t v = 1; v + 1 < kSide; ++v) {
    for (std::size_t u = 0; u < kSide; ++u) {
      const std::size_t k = v * kSide + u;
      const float w = kWeights.w[k];
      // On the rim the neighbours are another row's; the weight is 0 there.
      const float gx = 0.25F * (sum[k + 1] - sum[k - 1]);
      const float gy = 0.25F * (sum[k + kSide] - sum[k - kSide]);
      const float gt = gy * kWeights.x[k] - gx * kWeights.y[k];
      const float gc = contrast[k];
      const float wx = w * gx;
      const float wy = w * gy;
      const float wt = w * gt;
      const float wc = w * gc;
      sums[0][u] += wx * gx;
      sums[1][u] += wx * gy;
      sums[2][u] += wx * gt;
      sums[3][u] += wx * gc;
      sums[4][u] += wy * gy;
      sums[5][u] += wy * gt;
      sums[6][u] += wy * gc;
      sums[7][u] += wt * gt;
      sums[8][u] += wt * gc;
      sums[9][u] += wc * gc;
      sums[10][u] += wx * difference[k];
      sums[11][u] += wy * difference[k];
      sums[12][u] += wt * difference[k];
      sums[13][u] += wc * difference[k];
      sums[14][u] += wx;
      sums[15][u] += wy;
      sums[16][u] += wt;
      sums[17][u] += wc;
      sums[18][u] += w * difference[k];
    }
  }
  std::array<float, kSums> s = {};
  for (std::size_t i = 0; i < kSums; ++i) {
    for (const float part : sums[i]) s[i] += part;
  }
  Eigen::Matrix4f N;
  N << s[0], s[1], s[2], s[3], s[1], s[4], s[5], s[6], s[2], s[5], s[7], s[8], s[3], s[6], s[8],
      s[9];
  // Each patch has no mean over all of it; under the weights the difference has one.
  const Eigen::Vector4f mean(s[14], s[15], s[16], s[17]);
  N -= mean * mean.transpose() / kWeights.sum;
  N.diagonal() += kPrior;
  const Eigen::Vector4f step =
      N.ldlt().solve(Eigen::Vector4f(s[10], s[11], s[12], s[13]) - s[18] / kWeights.sum * mean);
  // seen(x) = look(x + step): the look's centre lies at -step.
  const Eigen::Vector2f shift = -step.head<2>();
  if (!(shift.norm() < kMostShift_px)) return std::nullopt;
  return shift;
}

}  // namespace zenith
