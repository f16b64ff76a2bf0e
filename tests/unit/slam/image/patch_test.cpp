#include "slam/image/patch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "slam/geometry.h"
#include "slam/image/ncc.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

constexpr int kSize = 64;

struct Picture {
  std::vector<std::uint8_t> data = std::vector<std::uint8_t>(kSize * kSize);
  ImageView view() const { return {data.data(), kSize, kSize, kSize}; }
};

template <typename Grey>
Picture paint(const Grey& grey) {
  Picture p;
  for (int v = 0; v < kSize; ++v) {
    for (int u = 0; u < kSize; ++u) {
      p.data[static_cast<std::size_t>(v * kSize + u)] =
          static_cast<std::uint8_t>(std::clamp(std::lround(grey(u, v)), 0L, 255L));
    }
  }
  return p;
}

// A smooth look: a few waves, and a slope that gives it a direction.
struct Look {
  double waves[5][4];
  explicit Look(Random& random) {
    for (auto& w : waves) {
      w[0] = random.uniform(-0.5, 0.5);
      w[1] = random.uniform(-0.5, 0.5);
      w[2] = random.uniform(0.0, 6.28);
      w[3] = random.uniform(3.0, 6.0);
    }
  }
  // Grey at (x, y) from the look's centre.
  double operator()(double x, double y) const {
    double sum = 120.0 + 5.0 * x;
    for (const auto& w : waves) sum += w[3] * std::sin(w[0] * x + w[1] * y + w[2]);
    return sum;
  }
};

// The look turned by `angle` about (u0, v0).
Picture turned(const Look& look, double angle, double u0, double v0, double gain = 1.0,
               double offset = 0.0) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return paint([&](double u, double v) {
    const double x = u - u0;
    const double y = v - v0;
    return offset + gain * look(c * x + s * y, c * y - s * x);
  });
}

double difference(float a, double b) {
  return std::abs(wrap_angle(static_cast<double>(a) - b));
}

TEST(Patch, OrientationIsTheSlopesDirection) {
  for (int k = -12; k < 12; ++k) {
    const double angle = k * std::numbers::pi / 12.0;
    const Picture p = paint([angle](double u, double v) {
      return 128.0 + 3.0 * (std::cos(angle) * (u - 32.0) + std::sin(angle) * (v - 32.0));
    });
    EXPECT_LT(difference(patch_orientation(p.view(), 32.3F, 31.6F), angle), 0.02) << k;
  }
}

TEST(Patch, OrientationTurnsWithTheLook) {
  const TestSeed seed;
  Random random(seed.value());
  for (int trial = 0; trial < 50; ++trial) {
    const Look look(random);
    const float before = patch_orientation(turned(look, 0.0, 32.0, 32.0).view(), 32.0F, 32.0F);
    const double angle = random.uniform(-3.1, 3.1);
    const double u0 = random.uniform(31.0, 33.0);
    const double v0 = random.uniform(31.0, 33.0);
    const float after = patch_orientation(turned(look, angle, u0, v0).view(),
                                          static_cast<float>(u0), static_cast<float>(v0));
    EXPECT_LT(difference(after, static_cast<double>(before) + angle), 0.05) << "trial " << trial;
  }
}

// The same corner from any heading and in any light gives the same patch; another corner does not.
TEST(Patch, IsTheSameFromEveryHeadingAndInEveryLight) {
  const TestSeed seed;
  Random random(seed.value());
  const auto sample = [](const Picture& p, double u, double v) {
    const auto fu = static_cast<float>(u);
    const auto fv = static_cast<float>(v);
    return sample_patch(p.view(), fu, fv, patch_orientation(p.view(), fu, fv));
  };
  double others = 0.0;
  for (int trial = 0; trial < 50; ++trial) {
    const Look look(random);
    const Patch a = sample(turned(look, 0.0, 32.0, 32.0), 32.0, 32.0);
    const double u0 = random.uniform(31.0, 33.0);
    const double v0 = random.uniform(31.0, 33.0);
    const Picture again =
        turned(look, random.uniform(-3.1, 3.1), u0, v0, random.uniform(0.4, 0.8), 40.0);
    const Patch b = sample(again, u0, v0);
    EXPECT_GT(ncc(a, b), 0.97F) << "trial " << trial;
    EXPECT_GT(ncc(compact(a), compact(b)), 0.97F) << "trial " << trial;
    const Patch c = sample(turned(Look(random), 0.0, 32.0, 32.0), 32.0, 32.0);
    others += static_cast<double>(ncc(a, c)) / 50.0;
  }
  EXPECT_LT(others, 0.95);  // all share the slope, so they are not unlike either
}

Patch quantised(const std::vector<double>& values) {
  Patch patch;
  int sum = 0;
  for (std::size_t i = 0; i < patch.values.size(); ++i) {
    const int q = static_cast<int>(std::lround(values[i]));
    patch.values[i] = static_cast<std::int8_t>(q);
    sum += q * q;
  }
  patch.inverse_norm = 1.0F / std::sqrt(static_cast<float>(sum));
  return patch;
}

double reference_ncc(const Patch& a, const Patch& b) {
  double ab = 0.0;
  double aa = 0.0;
  double bb = 0.0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    const double x = a.values[i];
    const double y = b.values[i];
    ab += x * y;
    aa += x * x;
    bb += y * y;
  }
  return ab / std::sqrt(aa * bb);
}

Patch noise_patch(Random& random) {
  std::vector<double> values(kPatchLength);
  for (double& v : values) v = random.uniform(-127.0, 127.0);
  return quantised(values);
}

TEST(Ncc, IsTheNormalisedDotProduct) {
  const TestSeed seed;
  Random random(seed.value());
  for (int trial = 0; trial < 200; ++trial) {
    const Patch a = noise_patch(random);
    Patch b = noise_patch(random);
    EXPECT_NEAR(static_cast<double>(ncc(a, b)), reference_ncc(a, b), 1e-5);
    EXPECT_FLOAT_EQ(ncc(a, b), ncc(b, a));
    EXPECT_NEAR(ncc(a, a), 1.0F, 1e-5F);
    b = a;
    for (auto& v : b.values) v = static_cast<std::int8_t>(-v);
    EXPECT_NEAR(ncc(a, b), -1.0F, 1e-5F);
  }
}

TEST(Ncc, WithoutContrastNothingIsSimilar) {
  const Picture plain = paint([](double, double) { return 130.0; });
  const Patch patch = sample_patch(plain.view(), 32.0F, 32.0F, 0.3F);
  EXPECT_EQ(patch.inverse_norm, 0.0F);
  const CompactPatch small = compact(patch);
  EXPECT_EQ(small.inverse_norm, 0.0F);
  EXPECT_EQ(ncc(patch, patch), 0.0F);
  EXPECT_EQ(ncc(small, small), 0.0F);
}

// A patch of cosines whose two frequencies sum to 1..6: all within the 32 that are kept.
std::vector<double> low_pass(Random& random, double amplitude) {
  std::vector<double> values(kPatchLength, 0.0);
  for (int fu = 0; fu <= 6; ++fu) {
    for (int fv = 0; fu + fv <= 6; ++fv) {
      if (fu + fv == 0) continue;
      const double a = amplitude * random.normal();
      for (int y = 0; y < kPatchSize; ++y) {
        for (int x = 0; x < kPatchSize; ++x) {
          values[static_cast<std::size_t>(y * kPatchSize + x)] +=
              a * std::cos(std::numbers::pi * (x + 0.5) * fu / kPatchSize) *
              std::cos(std::numbers::pi * (y + 0.5) * fv / kPatchSize);
        }
      }
    }
  }
  return values;
}

// An orthonormal transform keeps dot products: the compact NCC is the full one when nothing above
// the kept frequencies is there. int8 costs a hundredth.
TEST(Compact, KeepsTheNccOfLowPassedPatches) {
  const TestSeed seed;
  Random random(seed.value());
  for (int trial = 0; trial < 300; ++trial) {
    const Patch a = quantised(low_pass(random, 4.5));
    const Patch b = quantised(low_pass(random, 4.5));
    EXPECT_NEAR(ncc(compact(a), compact(b)), ncc(a, b), 0.02F) << "trial " << trial;
  }
}

TEST(Compact, DoesNotSeeFineDetail) {
  const TestSeed seed;
  Random random(seed.value());
  const std::vector<double> low = low_pass(random, 4.5);
  std::vector<double> fine = low;
  for (int i = 0; i < kPatchLength; ++i) {
    const int x = i % kPatchSize;
    fine[static_cast<std::size_t>(i)] +=
        20.0 * std::cos(std::numbers::pi * (x + 0.5) * 13 / kPatchSize);
  }
  EXPECT_LT(ncc(quantised(low), quantised(fine)), 0.95F);
  EXPECT_GT(ncc(compact(quantised(low)), compact(quantised(fine))), 0.998F);
}

TEST(Compact, SurvivesTheJourneyAsBytes) {
  const TestSeed seed;
  Random random(seed.value());
  for (int trial = 0; trial < 100; ++trial) {
    const CompactPatch sent = compact(noise_patch(random));
    const CompactPatch got = compact_from(sent.values);
    EXPECT_EQ(got.values, sent.values);
    EXPECT_EQ(got.inverse_norm, sent.inverse_norm);
  }
  EXPECT_EQ(compact_from({}).inverse_norm, 0.0F);
}

}  // namespace
}  // namespace zenith
