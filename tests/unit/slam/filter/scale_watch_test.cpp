#include "slam/filter/scale_watch.h"

#include <cmath>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

// Frames until it speaks up, or -1: the landmarks tell `factor` times what the wheels tell.
int frames_until_wrong(double frame_m, double factor, double noise_m) {
  const TestSeed seed;
  Random random(seed.value());
  ScaleWatch watch;
  for (int i = 0; i < 1000; ++i) {
    const double seen_m = factor * frame_m + noise_m * random.normal();
    if (watch.note(frame_m, seen_m)) return i;
  }
  return -1;
}

TEST(ScaleWatch, SpeaksUpAfterHalfAMetreOfOneFactor) {
  for (const double factor : {0.5, 0.77, 1.3, 1.8}) {
    for (const double frame_m : {0.003, 0.016, 0.12, -0.016}) {
      const int frames = frames_until_wrong(frame_m, factor, 0.0002);
      ASSERT_GE(frames, 0) << factor << " " << frame_m;
      EXPECT_LT(std::abs(frame_m) * frames, 1.3) << factor << " " << frame_m;
    }
  }
}

TEST(ScaleWatch, IsContentWithWheelsThatAreAFewPercentOff) {
  for (const double factor : {0.98, 1.0, 1.02}) {
    EXPECT_EQ(frames_until_wrong(0.016, factor, 0.0005), -1) << factor;
  }
}

TEST(ScaleWatch, SpinningWheelsAreNoScale) {
  EXPECT_EQ(frames_until_wrong(0.016, 0.0, 0.0005), -1);
  ScaleWatch changing;
  for (int i = 0; i < 1000; ++i) {
    EXPECT_FALSE(changing.note(0.016, i % 20 < 8 ? 0.016 : 0.004)) << i;
  }
}

TEST(ScaleWatch, AStandingRobotTellsNothing) {
  ScaleWatch watch;
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(watch.note(0.0, i % 2 == 0 ? 0.001 : -0.001));
}

}  // namespace
}  // namespace zenith
