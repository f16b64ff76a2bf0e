#include "slam/image/view.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "slam/image/pixel_growth.h"
#include "slam/image/rectify.h"
#include "tests/support/arena_block.h"
#include "tests/support/lenses.h"

namespace zenith {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// A pinhole whose image's diagonal shows so many degrees.
Lens pinhole_of(double diagonal_deg) {
  Lens lens = lens_of(LensModel::kRadtan, 640, 480, 1.0);
  lens.cu_px = 319.5;
  lens.cv_px = 239.5;
  lens.fu_px = lens.fv_px = std::hypot(319.5, 239.5) / std::tan(0.5 * diagonal_deg * kDegree);
  return lens;
}

View view_of_lens(const Lens& lens, const CameraMount& mount = {}) {
  return fitted_view(LensProjection(lens), mount);
}

TEST(View, AWideLensHasTheFieldThatMeasuredBest) {
  Lens simulated;
  simulated.k = {-0.012, 0.004, -0.0015, 0.0001};
  for (const double lean : {0.0, 0.05, 0.15}) {
    CameraMount mount;
    mount.pitch_rad = lean;
    mount.roll_rad = -0.5 * lean;
    mount.yaw_rad = 4.0 * lean;
    const View view = view_of_lens(simulated, mount);
    EXPECT_EQ(view.fov_deg, 112.0);
    EXPECT_EQ(view.inside_share, 1.0);
  }
  RobotConfig robot;
  robot.lens = simulated;
  EXPECT_EQ(with_fitted_view({}, robot).rectified_fov_deg, 112.0);
  Parameters given;
  given.rectified_fov_deg = 95.5;
  EXPECT_EQ(with_fitted_view(given, robot).rectified_fov_deg, 95.5);
  EXPECT_EQ(view_of(given, robot).fov_deg, 95.5);
}

// The whole sensor: from side to side of its longer side, all of the shorter one inside.
TEST(View, ANarrowLensUsesItsWholeSensor) {
  for (const double diagonal : {50.0, 60.0, 70.0, 85.0, 100.0}) {
    const Lens lens = pinhole_of(diagonal);
    const View view = view_of_lens(lens);
    const double wide_deg = 2.0 * std::atan(319.5 / lens.fu_px) / kDegree;
    EXPECT_NEAR(view.fov_deg, wide_deg, 0.11) << diagonal;
    EXPECT_GE(view.fov_deg, wide_deg) << diagonal;
    EXPECT_NEAR(view.inside_share, 0.75, 0.02) << diagonal;
  }
}

// The share is that of the pixels that the rectifier fills.
TEST(View, TheShareIsWhatTheRectifierSees) {
  CameraMount leaning;
  leaning.pitch_rad = 0.12;
  leaning.yaw_rad = 0.8;
  Rectifier rectifier;
  const ArenaBlock block([&](Arena& arena) { rectifier.layout(arena); });
  for (const auto& [name, lens, whole] : lenses_of_all_models()) {
    for (const CameraMount& mount : {CameraMount{}, leaning}) {
      const View view = view_of_lens(lens, mount);
      EXPECT_GE(view.fov_deg, 40.0) << name;
      EXPECT_LE(view.fov_deg, 112.0) << name;
      EXPECT_GE(view.inside_share, 0.48) << name;
      rectifier.build(lens, mount, Pinhole::from_fov(view.fov_deg * kDegree));
      int inside = 0;
      for (int v = 0; v < kRectifiedSize; ++v) {
        for (int u = 0; u < kRectifiedSize; ++u) inside += rectifier.sees(u, v, 0);
      }
      EXPECT_NEAR(inside / double{kRectifiedSize * kRectifiedSize}, view.inside_share, 0.015)
          << name;
    }
  }
}

// A narrow camera that leans: of the field that would hold all of its image it fills little.
TEST(View, HalfOfTheViewIsTheLenssOrAsMuchAsCanBe) {
  const Lens lens = pinhole_of(70.0);
  CameraMount mount;
  mount.pitch_rad = 10.0 * kDegree;
  View view = view_of_lens(lens, mount);
  EXPECT_NEAR(view.inside_share, 0.5, 0.03);
  const double whole_deg = 2.0 * (std::atan(319.5 / lens.fu_px) / kDegree + 10.0);
  EXPECT_LT(view.fov_deg, whole_deg);
  EXPECT_GT(view.fov_deg, 2.0 * std::atan(239.5 / lens.fv_px) / kDegree);
  mount.pitch_rad = 45.0 * kDegree;  // the vertical is out of sight
  view = view_of_lens(lens, mount);
  EXPECT_GT(view.inside_share, 0.1);
  EXPECT_LT(view.inside_share, 0.5);
  EXPECT_GT(view.fov_deg, 60.0);
}

// Where a curve folds in the image the view ends there.
TEST(View, AFoldInTheImageLimitsTheView) {
  Lens lens = lens_of(LensModel::kRadtan, 640, 480, 260.0);
  lens.k[0] = -0.3;
  const double limit_deg = LensProjection(lens).limit_rad() / kDegree;
  const View view = view_of_lens(lens);
  EXPECT_LT(view.fov_deg, 2.0 * limit_deg + 0.2);
  EXPECT_GT(view.fov_deg, 2.0 * limit_deg - 6.0);
}

TEST(View, WhatIsNoLensHasAViewAllTheSame) {
  Lens lens;
  lens.k[0] = std::nan("");
  const View view = view_of_lens(lens);
  EXPECT_GE(view.fov_deg, kNarrowestFitted_deg);
  EXPECT_EQ(view.inside_share, 0.0);
}

// Growth by differences: the tangents of two rays whose pixels lie one pixel apart.
TEST(PixelGrowth, IsThatOfTheLens) {
  for (const auto& [name, lens, whole] : lenses_of_all_models()) {
    const LensProjection projection(lens);
    if (projection.limit_rad() < 85.0 * kDegree) continue;  // not to be followed to a fold
    const double fov_deg = fitted_view(projection, {}).fov_deg;
    const PixelGrowth growth = pixel_growth(projection, fov_deg);
    const double f = projection.axis_slope();
    for (const double share : {0.1, 0.4, 0.7, 0.95}) {
      const double r = share * std::tan(0.5 * fov_deg * kDegree);
      constexpr double kStep = 1e-4;
      const double along =
          2.0 * kStep * f /
          (projection.rho(std::atan(r + kStep)) - projection.rho(std::atan(r - kStep)));
      const double across = r * f / projection.rho(std::atan(r));
      EXPECT_NEAR(growth.along(r) / along, 1.0, 0.3) << name << ' ' << r;
      EXPECT_NEAR(growth.across(r) / across, 1.0, 0.2) << name << ' ' << r;
      const double variance = growth.grown(1.0F, static_cast<float>(r * r));
      EXPECT_NEAR(variance / (along * across), 1.0, 0.35) << name << ' ' << r;
    }
  }
  const PixelGrowth pinhole = pixel_growth(LensProjection(pinhole_of(70.0)), 60.0);
  EXPECT_NEAR(pinhole.along(0.5), 1.0, 1e-4);
  EXPECT_NEAR(pinhole.across(0.5), 1.0, 1e-4);
}

}  // namespace
}  // namespace zenith
