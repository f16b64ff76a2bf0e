#include "slam/image/corners.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "slam/kernels/image/image_kernels.h"
#include "tests/support/arena_block.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

constexpr int kN = kRectifiedSize;
using Plane = std::vector<std::uint8_t>;

ImageView view_of(const Plane& plane) {
  return {plane.data(), kN, kN, kN};
}

struct Detector {
  CornerDetector detector;
  ArenaBlock block{[this](Arena& arena) { detector.layout(arena); }};

  Corners detect(const Plane& plane, const CornerSettings& settings) {
    Corners corners;
    detector.detect(view_of(plane), settings, corners);
    return corners;
  }
};

Plane paint(double (*grey)(double u, double v)) {
  Plane plane(kN * kN);
  for (int v = 0; v < kN; ++v) {
    for (int u = 0; u < kN; ++u) {
      plane[static_cast<std::size_t>(v * kN + u)] =
          static_cast<std::uint8_t>(std::lround(std::clamp(grey(u, v), 0.0, 255.0)));
    }
  }
  return plane;
}

Plane noise_image(Random& random) {
  Plane plane(kN * kN);
  for (auto& p : plane) p = static_cast<std::uint8_t>(random.below(256));
  return plane;
}

// Bright quarters of a plane, rounded to a pixel, every 40 pixels; each stands at its own fraction
// of a pixel.
constexpr double kSpacing = 40.13;
double corner_place(double k) {
  return 40.0 + k * kSpacing;
}
double quarters(double u, double v) {
  const double x = u - corner_place(std::round((u - 40.0) / kSpacing));
  const double y = v - corner_place(std::round((v - 40.0) / kSpacing));
  const double inside = (1.0 + std::tanh(x)) * (1.0 + std::tanh(y));
  return 100.0 + 25.0 * inside * std::exp(-(x * x + y * y) / 80.0);
}

// Harris puts the corner of a quarter a pixel inside it, always by the same amount: what counts is
// that the corner found moves as the true one does.
TEST(Corners, FollowsTheCornerWithinAFractionOfAPixel) {
  Detector detector;
  const Corners corners = detector.detect(paint(quarters), {});
  for (int j = 0; j < 7; ++j) {
    for (int i = 0; i < 7; ++i) {
      double nearest = 1e9;
      constexpr double kInside = 1.02;
      for (const Corner& c : corners) {
        const double du = static_cast<double>(c.u_px) - corner_place(i) - kInside;
        const double dv = static_cast<double>(c.v_px) - corner_place(j) - kInside;
        nearest = std::min(nearest, std::hypot(du, dv));
      }
      EXPECT_LT(nearest, 0.15) << i << ' ' << j;
    }
  }
}

TEST(Corners, NeitherPlainsNorEdgesAreCorners) {
  Detector detector;
  EXPECT_TRUE(detector.detect(paint([](double, double) { return 90.0; }), {}).empty());
  EXPECT_TRUE(detector.detect(paint([](double u, double) { return u < 150.0 ? 20.0 : 220.0; }), {})
                  .empty());
  const auto slanted = [](double u, double v) {
    return 128.0 + 100.0 * std::tanh(0.5 * (u + 0.7 * v - 250.0));
  };
  EXPECT_TRUE(detector.detect(paint(slanted), {}).empty());
}

TEST(Corners, AreSpreadSortedAndWithinLimits) {
  const TestSeed seed;
  Random random(seed.value());
  Detector detector;
  const Plane plane = noise_image(random);
  CornerSettings settings;
  settings.min_distance_px = 9.0;
  settings.per_cell = 2;
  settings.max_corners = 100;
  const Corners corners = detector.detect(plane, settings);
  EXPECT_EQ(corners.size(), 100U);
  std::array<int, 100> cell = {};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Corner& a = corners[i];
    EXPECT_GE(a.u_px, 12.0F);
    EXPECT_LE(a.u_px, static_cast<float>(kN - 13));
    EXPECT_GE(a.v_px, 12.0F);
    EXPECT_LE(a.v_px, static_cast<float>(kN - 13));
    if (i > 0) {
      EXPECT_LE(a.response, corners[i - 1].response);
    }
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_GE(std::hypot(a.u_px - corners[k].u_px, a.v_px - corners[k].v_px), 8.999F);
    }
    const auto c = static_cast<std::size_t>(static_cast<int>(a.v_px) / 32 * 10 +
                                            static_cast<int>(a.u_px) / 32);
    EXPECT_LE(++cell[c], 2);
  }
}

TEST(Corners, FullIsNoError) {
  const TestSeed seed;
  Random random(seed.value());
  Detector detector;
  CornerSettings settings;
  settings.max_corners = 10'000;
  settings.per_cell = 100;
  settings.min_distance_px = 1.0;
  settings.min_eigenvalue = 0.0;
  EXPECT_EQ(detector.detect(noise_image(random), settings).size(), Corners::capacity());
}

TEST(Corners, WeakOnesAreLeftOut) {
  Detector detector;
  const Plane plane =
      paint([](double u, double v) { return 100.0 + 0.05 * (quarters(u, v) - 100.0); });
  CornerSettings settings;
  settings.min_eigenvalue = 20.0;
  EXPECT_TRUE(detector.detect(plane, settings).empty());
  settings.min_eigenvalue = 0.05;
  EXPECT_GE(detector.detect(plane, settings).size(), 49U);
}

// The kernel against its definition, pixel by pixel in double.
TEST(Corners, ResponseIsHarrisDefinition) {
  const TestSeed seed;
  Random random(seed.value());
  const Plane plane = noise_image(random);
  std::vector<float> response(kN * kN);
  std::vector<float> scratch(harris_scratch(kN));
  image_kernels().harris(plane.data(), kN, kN, 0.0F, response.data(), scratch.data());
  const auto at = [&plane](int u, int v) {
    return static_cast<double>(plane[static_cast<std::size_t>(v * kN + u)]);
  };
  constexpr std::array<double, 7> kBinomial = {1.0, 6.0, 15.0, 20.0, 15.0, 6.0, 1.0};
  for (int trial = 0; trial < 500; ++trial) {
    const int u = 13 + static_cast<int>(random.below(kN - 26));
    const int v = 13 + static_cast<int>(random.below(kN - 26));
    double a = 0.0;
    double b = 0.0;
    double c = 0.0;
    for (int y = -3; y <= 3; ++y) {
      for (int x = -3; x <= 3; ++x) {
        double gx = 0.0;
        double gy = 0.0;
        for (int k = -1; k <= 1; ++k) {
          const double w = k == 0 ? 10.0 / 32.0 : 3.0 / 32.0;
          gx += w * (at(u + x + 1, v + y + k) - at(u + x - 1, v + y + k));
          gy += w * (at(u + x + k, v + y + 1) - at(u + x + k, v + y - 1));
        }
        const double w = kBinomial[static_cast<std::size_t>(x + 3)] *
                         kBinomial[static_cast<std::size_t>(y + 3)] / 4096.0;
        a += w * gx * gx;
        b += w * gx * gy;
        c += w * gy * gy;
      }
    }
    const double expected = std::max(a * c - b * b - 0.04 * (a + c) * (a + c), 0.0);
    const auto got = static_cast<double>(response[static_cast<std::size_t>(v * kN + u)]);
    ASSERT_NEAR(got, expected, 1e-4 * (a + c) * (a + c)) << u << ' ' << v;
  }
}

}  // namespace
}  // namespace zenith
