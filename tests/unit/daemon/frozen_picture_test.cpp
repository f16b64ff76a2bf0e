#include "platform/daemon/frozen_picture.h"

#include <vector>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

using Verdict = FrozenPicture::Verdict;

class FrozenPictureTest : public testing::Test {
 protected:
  static constexpr int kWidth_px = 641;  // no multiple of a word
  static constexpr int kHeight_px = 480;
  static constexpr int kStride = 704;

  FrozenPictureTest() { paint(); }

  // Another picture, with noise all over it.
  void paint() {
    for (auto& pixel : pixels_) pixel = static_cast<std::uint8_t>(20 + random_.below(200));
  }
  Verdict judge() { return frozen_.judge({pixels_.data(), kWidth_px, kHeight_px, kStride}); }
  void drive(double left_m, double right_m) {
    left_m_ += left_m;
    right_m_ += right_m;
    stamp_ = stamp_ + Duration{10'000'000};
    frozen_.note_wheels({stamp_, left_m_, right_m_});
  }

  const TestSeed seed_;
  Random random_{seed_.value(), 1};
  FrozenPicture frozen_;
  std::vector<std::uint8_t> pixels_ =
      std::vector<std::uint8_t>(static_cast<std::size_t>(kStride) * kHeight_px);
  Time stamp_;
  double left_m_ = 123.0;
  double right_m_ = -45.0;
};

TEST_F(FrozenPictureTest, ARobotThatDrivesWithAGoodCameraIsNeverSuspected) {
  for (int i = 0; i < 200; ++i) {
    drive(0.05, 0.04);
    paint();
    ASSERT_EQ(judge(), Verdict::kNew) << i;
  }
}

// A test pattern, a simulated robot at the end of its path, a recording's last picture.
TEST_F(FrozenPictureTest, ARobotThatStandsMaySeeTheSamePictureForEver) {
  drive(0, 0);
  EXPECT_EQ(judge(), Verdict::kNew);
  for (int i = 0; i < 100'000; ++i) {
    // Wheels on the edge between two counts.
    drive(i % 2 == 0 ? 0.001 : -0.001, 0);
    ASSERT_EQ(judge(), Verdict::kRepeated) << i;
  }
}

TEST_F(FrozenPictureTest, WithoutWheelsNothingIsSaid) {
  for (int i = 0; i < 100; ++i) ASSERT_NE(judge(), Verdict::kFrozen);
}

TEST_F(FrozenPictureTest, TheSamePictureWhileTheRobotDrivesIsNotUsedAndThenFrozen) {
  drive(0, 0);
  EXPECT_EQ(judge(), Verdict::kNew);
  EXPECT_EQ(judge(), Verdict::kRepeated);
  drive(0.02, 0.02);
  EXPECT_EQ(judge(), Verdict::kStale);
  drive(0.02, 0.02);
  EXPECT_EQ(judge(), Verdict::kStale) << "not far enough";
  drive(0.07, 0.07);
  EXPECT_EQ(judge(), Verdict::kFrozen);
  // It stays so when the robot stops, drives back, or the camera was opened again.
  EXPECT_EQ(judge(), Verdict::kFrozen);
  drive(-0.11, -0.11);
  EXPECT_EQ(judge(), Verdict::kFrozen);
  paint();
  EXPECT_EQ(judge(), Verdict::kNew);
  EXPECT_EQ(judge(), Verdict::kRepeated);
}

TEST_F(FrozenPictureTest, ATurnOnTheSpotIsMotion) {
  drive(0, 0);
  judge();
  for (int i = 0; i < 4; ++i) {
    drive(-0.03, 0.03);
    judge();
  }
  EXPECT_EQ(judge(), Verdict::kFrozen);
}

// A driver that gives every picture twice: the second one is not used, the camera is left alone.
TEST_F(FrozenPictureTest, PicturesThatComeTwiceAreNotFrozen) {
  for (int i = 0; i < 100; ++i) {
    paint();
    drive(0.2, 0.2);
    ASSERT_EQ(judge(), Verdict::kNew);
    drive(0.2, 0.2);
    ASSERT_EQ(judge(), Verdict::kStale);
  }
}

TEST_F(FrozenPictureTest, OnePixelOfASampledRowMakesAnother) {
  drive(0, 0);
  judge();
  drive(0.5, 0.5);
  for (int row = 0; row < FrozenPicture::kRows; ++row) {
    const int v = (2 * row + 1) * kHeight_px / (2 * FrozenPicture::kRows);
    for (const int u : {0, 7, 320, 639, 640}) {
      pixels_[static_cast<std::size_t>(v) * kStride + static_cast<std::size_t>(u)] ^= 1U;
      EXPECT_EQ(judge(), Verdict::kNew) << u << " " << v;
    }
  }
  const std::size_t v = kHeight_px / (2 * FrozenPicture::kRows);
  pixels_[v * kStride + kWidth_px + 3] ^= 1U;  // beyond the row's end
  EXPECT_EQ(judge(), Verdict::kRepeated);
}

// A covered lens, a dark hall, lamps that blind it: all pixels at their ends, without noise.
TEST_F(FrozenPictureTest, BlackAndWhitePicturesProveNothing) {
  for (const int grey : {0, 3, 255}) {
    pixels_.assign(pixels_.size(), static_cast<std::uint8_t>(grey));
    for (int i = 0; i < 100; ++i) {
      drive(0.05, 0.05);
      ASSERT_EQ(judge(), Verdict::kNew) << grey;
    }
  }
}

TEST_F(FrozenPictureTest, PicturesWithoutRowsOrColumnsAreTaken) {
  const ImageView none = {pixels_.data(), 0, 0, 0};
  const ImageView one = {pixels_.data(), 1, 1, 1};
  for (int i = 0; i < 10; ++i) {
    drive(0.05, 0.05);
    EXPECT_EQ(frozen_.judge(none), Verdict::kNew);
    EXPECT_EQ(frozen_.judge(one), Verdict::kNew);
  }
}

}  // namespace
}  // namespace zenith
