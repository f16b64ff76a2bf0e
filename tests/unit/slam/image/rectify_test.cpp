#include "slam/image/rectify.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "slam/image/lens_projection.h"
#include "tests/support/arena_block.h"

namespace zenith {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct Rig {
  Rectifier rectifier;
  ArenaBlock block{[this](Arena& arena) { rectifier.layout(arena); }};
  std::vector<std::uint8_t> out = std::vector<std::uint8_t>(kRectifiedSize * kRectifiedSize, 77);

  MutableImageView view() { return {out.data(), kRectifiedSize, kRectifiedSize, kRectifiedSize}; }
  int at(int u, int v) const { return out[static_cast<std::size_t>(v * kRectifiedSize + u)]; }
};

// A frame whose grey is a plane over the pixels: bilinear reading is exact but for rounding.
struct Ramp {
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;
  std::vector<std::uint8_t> data;

  Ramp(const Lens& lens, std::ptrdiff_t padding, bool along_u)
      : width(lens.width_px), height(lens.height_px), stride(lens.width_px + padding) {
    data.assign(static_cast<std::size_t>(stride * height), 255);
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        data[static_cast<std::size_t>(v * stride + u)] =
            static_cast<std::uint8_t>(along_u ? u * 255 / width : v * 255 / height);
      }
    }
  }
  ImageView view() const { return {data.data(), width, height, stride}; }
};

TEST(Rectify, MountRotationTurnsRollThenPitchThenYaw) {
  const CameraMount level;
  EXPECT_TRUE(mount_rotation(level).isIdentity(1e-15));
  CameraMount yawed;
  yawed.yaw_rad = 0.5 * std::numbers::pi;
  // The camera's x axis points to the robot's left.
  EXPECT_LT((mount_rotation(yawed) * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(),
            1e-12);
  CameraMount pitched;
  pitched.pitch_rad = 0.1;  // leans forward
  const Eigen::Vector3d axis = mount_rotation(pitched) * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(axis.x(), std::sin(0.1), 1e-12);
  CameraMount rolled = pitched;
  rolled.roll_rad = 0.2;
  rolled.yaw_rad = 0.3;
  const Eigen::Vector3d p = mount_rotation(rolled) * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(p.z(), -std::sin(0.1), 1e-12);
  EXPECT_NEAR(std::atan2(p.y(), p.x()), 0.3, 1e-12);
}

TEST(Rectify, PinholeCoversItsField) {
  const Pinhole p = Pinhole::from_fov(120.0 * kDegree);
  EXPECT_NEAR(p.normalise(kRectifiedSize - 0.5, 159.5).x(), std::tan(60.0 * kDegree), 1e-9);
  EXPECT_NEAR(p.normalise(p.centre_px, p.centre_px).norm(), 0.0, 1e-12);
  const Eigen::Vector2d back = p.pixel(p.normalise(12.25, 301.5));
  EXPECT_NEAR(back.x(), 12.25, 1e-9);
  EXPECT_NEAR(back.y(), 301.5, 1e-9);
}

// Lens, tilt, roll and yaw together: each rectified pixel shows what its ray hits.
TEST(Rectify, EachPixelShowsItsRay) {
  Lens lens;
  lens.k = {0.02, -0.004, 0.001, 0.0};
  CameraMount mount;
  const LensProjection projection(lens);
  mount.roll_rad = 0.04;
  mount.pitch_rad = -0.06;
  mount.yaw_rad = 1.1;
  const Pinhole pinhole = Pinhole::from_fov(110.0 * kDegree);
  Rig rig;
  rig.rectifier.build(lens, mount, pinhole);
  for (const bool along_u : {true, false}) {
    const Ramp ramp(lens, 0, along_u);
    rig.rectifier.apply(ramp.view(), rig.view());
    int inside = 0;
    for (int v = 0; v < kRectifiedSize; v += 3) {
      for (int u = 0; u < kRectifiedSize; u += 3) {
        if (!rig.rectifier.sees(u, v, 0)) continue;
        ++inside;
        const Eigen::Vector2d m = pinhole.normalise(u, v);
        const Eigen::Vector2d at =
            projection
                .project(mount_rotation(mount).transpose() * Eigen::Vector3d(m.x(), m.y(), 1.0))
                .value();
        const double grey =
            along_u ? at.x() * 255.0 / lens.width_px : at.y() * 255.0 / lens.height_px;
        // The ramp itself is rounded down to whole levels.
        ASSERT_NEAR(rig.at(u, v), grey - 0.5, 1.1) << u << ' ' << v;
      }
    }
    EXPECT_GT(inside, 10'000);
  }
}

// Looking up nothing is mirrored: a light ahead appears at larger u, one to the left at larger v.
TEST(Rectify, ForwardIsRightAndLeftIsDown) {
  const Lens lens;
  const Pinhole pinhole = Pinhole::from_fov(120.0 * kDegree);
  Rig rig;
  rig.rectifier.build(lens, {}, pinhole);
  for (const Eigen::Vector2d& m : {Eigen::Vector2d(0.8, 0.0), Eigen::Vector2d(0.0, 0.8)}) {
    std::vector<std::uint8_t> frame(static_cast<std::size_t>(lens.width_px * lens.height_px), 0);
    const Eigen::Vector2d at = LensProjection(lens).project({m.x(), m.y(), 1.0}).value();
    for (int dv = -2; dv <= 2; ++dv) {
      for (int du = -2; du <= 2; ++du) {
        const auto u = std::lround(at.x()) + du;
        const auto v = std::lround(at.y()) + dv;
        frame[static_cast<std::size_t>(v * lens.width_px + u)] = 255;
      }
    }
    rig.rectifier.apply({frame.data(), lens.width_px, lens.height_px, lens.width_px}, rig.view());
    const Eigen::Vector2d expected = pinhole.pixel(m);
    EXPECT_GT(rig.at(static_cast<int>(expected.x()), static_cast<int>(expected.y())), 200);
    EXPECT_EQ(rig.at(static_cast<int>(319 - expected.x()), static_cast<int>(319 - expected.y())),
              0);
  }
}

TEST(Rectify, PaddedFramesReadTheSame) {
  const Lens lens;
  Rig dense;
  Rig padded;
  dense.rectifier.build(lens, {}, Pinhole::from_fov(2.0));
  padded.rectifier.build(lens, {}, Pinhole::from_fov(2.0));
  const Ramp a(lens, 0, true);
  const Ramp b(lens, 37, true);
  dense.rectifier.apply(a.view(), dense.view());
  padded.rectifier.apply(b.view(), padded.view());
  EXPECT_EQ(dense.out, padded.out);
}

// Frames of another size than the lens says, and none at all, are not read.
TEST(Rectify, WhatDoesNotFitIsNotRead) {
  const Lens lens;
  Rig rig;
  rig.rectifier.build(lens, {}, Pinhole::from_fov(2.0));
  const Ramp ramp(lens, 0, true);
  const ImageView good = ramp.view();
  ASSERT_TRUE(rig.rectifier.fits(good));
  rig.rectifier.apply(good, rig.view());
  const auto before = rig.out;
  for (const ImageView& bad :
       {ImageView{nullptr, good.width, good.height, good.stride},
        ImageView{good.data, good.width - 1, good.height, good.stride},
        ImageView{good.data, good.width, good.height + 1, good.stride},
        ImageView{good.data, good.width, good.height, good.width - 1},
        ImageView{good.data, good.width, good.height, -good.stride}, ImageView{}}) {
    EXPECT_FALSE(rig.rectifier.fits(bad));
    rig.rectifier.apply(bad, rig.view());
    EXPECT_EQ(rig.out, before);
  }
}

// A lens that projects to no numbers sees nothing; it does not read beside the frame.
TEST(Rectify, ALensThatIsNoNumberSeesNothing) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    Lens lens;
    lens.k[1] = bad;
    Rig rig;
    rig.rectifier.build(lens, {}, Pinhole::from_fov(2.0));
    EXPECT_FALSE(rig.rectifier.sees(20, 20, 2)) << bad;
    rig.rectifier.apply(Ramp(Lens{}, 0, true).view(), rig.view());
    EXPECT_EQ(rig.at(20, 20), 0) << bad;
  }
}

TEST(Rectify, WhatTheLensDoesNotSeeIsBlack) {
  Lens lens;
  lens.width_px = 320;
  lens.height_px = 200;
  lens.cu_px = 160.0;
  lens.cv_px = 100.0;
  Rig rig;
  rig.rectifier.build(lens, {}, Pinhole::from_fov(120.0 * kDegree));
  const std::vector<std::uint8_t> frame(static_cast<std::size_t>(320 * 200), 200);
  rig.rectifier.apply({frame.data(), 320, 200, 320}, rig.view());
  EXPECT_EQ(rig.at(160, 160), 200);
  EXPECT_EQ(rig.at(160, 2), 0);  // 60 degrees to the side: 157 pixels from the centre
  EXPECT_TRUE(rig.rectifier.sees(160, 160, 20));
  EXPECT_FALSE(rig.rectifier.sees(160, 2, 0));
  EXPECT_FALSE(rig.rectifier.sees(310, 160, 20));
  EXPECT_FALSE(rig.rectifier.sees(-1, 160, 0));
  for (int v = 0; v < kRectifiedSize; ++v) {
    for (int u = 0; u < kRectifiedSize; ++u) {
      ASSERT_EQ(rig.at(u, v), rig.rectifier.sees(u, v, 0) ? 200 : 0) << u << ' ' << v;
    }
  }
}

}  // namespace
}  // namespace zenith
