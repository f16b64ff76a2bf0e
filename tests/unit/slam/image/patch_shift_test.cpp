#include "slam/image/patch_shift.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "platform/base/random.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

constexpr int kSize = 64;

// A smooth picture of random waves, none shorter than five pixels, sampled anywhere.
class Waves {
 public:
  explicit Waves(Random& random) {
    for (int k = 0; k < 12; ++k) {
      const double length_px = 5.0 + 12.0 * random.uniform();
      const double turn = 2.0 * std::numbers::pi * random.uniform();
      const double f = 2.0 * std::numbers::pi / length_px;
      waves_.push_back({f * std::cos(turn), f * std::sin(turn), 6.3 * random.uniform()});
    }
  }
  // The picture moved by (dx, dy), with noise of so many grey levels.
  std::vector<std::uint8_t> picture(double dx, double dy, double noise, Random& random) const {
    std::vector<std::uint8_t> out;
    for (int v = 0; v < kSize; ++v) {
      for (int u = 0; u < kSize; ++u) {
        double grey = 128.0 + noise * random.normal();
        for (const auto& w : waves_)
          grey += 9.0 * std::sin(w[0] * (u - dx) + w[1] * (v - dy) + w[2]);
        out.push_back(static_cast<std::uint8_t>(std::clamp(grey, 0.0, 255.0)));
      }
    }
    return out;
  }

 private:
  std::vector<std::array<double, 3>> waves_;
};

Patch patch_of(const std::vector<std::uint8_t>& picture, double turn_rad = 0.0) {
  const ImageView view = {picture.data(), kSize, kSize, kSize};
  return sample_patch(view, 32.0F, 32.0F, static_cast<float>(turn_rad));
}

TEST(PatchShift, FindsAShiftToAPartOfAPixel) {
  const TestSeed seed;
  Random random(seed.value());
  double squares = 0.0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    const Waves waves(random);
    const double dx = 1.4 * random.uniform() - 0.7;
    const double dy = 1.4 * random.uniform() - 0.7;
    const double turn = 0.1 * random.uniform() - 0.05;
    const auto shift = patch_shift(patch_of(waves.picture(0.0, 0.0, 1.0, random)),
                                   patch_of(waves.picture(dx, dy, 1.0, random), turn));
    ASSERT_TRUE(shift.has_value());
    const Eigen::Vector2f in_patch =
        Eigen::Rotation2Df(static_cast<float>(-turn)) * Eigen::Vector2f(dx, dy);
    squares += static_cast<double>((*shift - in_patch).squaredNorm());
  }
  EXPECT_LT(std::sqrt(squares / kRuns), 0.1);
}

TEST(PatchShift, ContrastDoesNotMatter) {
  const TestSeed seed;
  Random random(seed.value());
  const Waves waves(random);
  auto picture = waves.picture(0.4, -0.3, 0.0, random);
  for (auto& grey : picture) grey = static_cast<std::uint8_t>(30 + grey / 2);
  const auto shift = patch_shift(patch_of(waves.picture(0.0, 0.0, 0.0, random)), patch_of(picture));
  ASSERT_TRUE(shift.has_value());
  EXPECT_NEAR(shift->x(), 0.4, 0.1);
  EXPECT_NEAR(shift->y(), -0.3, 0.1);
}

// Along the edge nothing is known, and nothing is invented.
TEST(PatchShift, AlongAnEdgeItStays) {
  std::vector<std::uint8_t> edge;
  std::vector<std::uint8_t> moved;
  for (int v = 0; v < kSize; ++v) {
    for (int u = 0; u < kSize; ++u) {
      const auto grey = [](double x) {
        return static_cast<std::uint8_t>(128.0 + 80.0 * std::tanh(0.5 * x));
      };
      edge.push_back(grey(u - 32.0));
      moved.push_back(grey(u - 32.5));
    }
  }
  const auto shift = patch_shift(patch_of(edge), patch_of(moved));
  ASSERT_TRUE(shift.has_value());
  EXPECT_NEAR(shift->x(), 0.5, 0.1);
  EXPECT_NEAR(shift->y(), 0.0, 0.05);
}

TEST(PatchShift, TwoDifferentLooksHaveNone) {
  const TestSeed seed;
  Random random(seed.value());
  int found = 0;
  for (int run = 0; run < 100; ++run) {
    const Patch a = patch_of(Waves(random).picture(0.0, 0.0, 0.0, random));
    const Patch b = patch_of(Waves(random).picture(0.0, 0.0, 0.0, random));
    const auto shift = patch_shift(a, b);
    if (!shift) continue;
    ++found;
    EXPECT_LT(shift->norm(), 1.5F);
  }
  EXPECT_LT(found, 100);
  const auto none = patch_shift(Patch{}, Patch{});
  EXPECT_TRUE(!none || none->norm() < 1e-6F);
}

}  // namespace
}  // namespace zenith
