// Moments of frames from stamps that jitter; stamps that do not, or a camera that is irregular
// itself, are left as they are.

#include "slam/filter/frame_clock.h"

#include <cmath>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/figure.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

constexpr double kPeriod_s = 0.1;

Time at(double seconds) {
  return {std::int64_t{5'000'000'000} + std::llround(seconds * 1e9)};
}

struct Errors {
  double raw_s = 0.0;  // rms of stamps, and of moments, after the first 150 frames
  double taken_s = 0.0;
  double jitter_s = 0.0;  // as told in the end
  bool rising = true;
  int changed = 0;  // frames whose moment is not their stamp
};

// `moment(i)`: when the i-th frame was taken; stamps scatter around it by `sigma_s`.
template <typename Moment>
Errors run(Random& random, int frames, double sigma_s, Moment&& moment) {
  FrameClock clock;
  Errors e;
  Time last = at(-1.0);
  Time last_stamp = at(-1.0);
  int counted = 0;
  for (int i = 0; i < frames; ++i) {
    const double truth = moment(i);
    const Time stamp = std::max(at(truth + sigma_s * random.normal()), last_stamp + Duration{1000});
    last_stamp = stamp;
    const Time taken = clock.taken(stamp);
    e.rising = e.rising && taken > last;
    e.changed += taken == stamp ? 0 : 1;
    last = taken;
    if (i < 150) continue;
    ++counted;
    e.raw_s += std::pow((stamp - at(truth)).seconds(), 2);
    e.taken_s += std::pow((taken - at(truth)).seconds(), 2);
  }
  e.raw_s = std::sqrt(e.raw_s / counted);
  e.taken_s = std::sqrt(e.taken_s / counted);
  e.jitter_s = clock.jitter_s();
  return e;
}

double regular(int i) {
  return i * kPeriod_s;
}

TEST(FrameClock, JitterIsTakenOut) {
  const TestSeed seed;
  for (const double sigma_s : {0.005, 0.01, 0.025, 0.05}) {
    double raw = 0.0;
    double taken = 0.0;
    constexpr int kRuns = 20;
    for (std::uint64_t i = 0; i < kRuns; ++i) {
      Random random(1000 * seed.value() + i);
      const Errors e = run(random, 400, sigma_s, regular);
      raw += e.raw_s / kRuns;
      taken += e.taken_s / kRuns;
      EXPECT_TRUE(e.rising);
      EXPECT_LT(e.taken_s, 1.2 * e.raw_s) << "run " << i << ", sigma " << sigma_s;
      if (sigma_s > 0.3 * kPeriod_s) continue;
      EXPECT_LT(e.taken_s, 0.6 * e.raw_s) << "run " << i << ", sigma " << sigma_s;
      EXPECT_NEAR(e.jitter_s, sigma_s, 0.3 * sigma_s) << "run " << i;
    }
    print_figure("frame clock: stamps off by %.1f ms, moments by %.1f ms", 1e3 * raw, 1e3 * taken);
    EXPECT_LT(taken, 0.6 * raw) << sigma_s;
  }
}

TEST(FrameClock, EvenStampsStayAsTheyAre) {
  const TestSeed seed;
  Random random(seed.value());
  const Errors e = run(random, 400, 0.0003, regular);
  EXPECT_EQ(e.changed, 0);
  EXPECT_EQ(e.jitter_s, 0.0);
}

// Exposures that vary, a processor that is now fast and now slow: each interval is its own.
TEST(FrameClock, AnIrregularCameraIsBelieved) {
  const TestSeed seed;
  for (std::uint64_t i = 0; i < 20; ++i) {
    Random random(seed.value() + i);
    double now = 0.0;
    const Errors e = run(random, 400, 0.0, [&](int) {
      now += kPeriod_s * (1.0 + 0.3 * random.uniform(-1.0, 1.0));
      return now;
    });
    EXPECT_LT(e.changed, 40) << "run " << i;
    EXPECT_TRUE(e.rising);
  }
}

// Frames that are missing are intervals that passed; after a long gap it begins anew.
TEST(FrameClock, MissingFramesAndGapsDoNotMatter) {
  const TestSeed seed;
  Random random(seed.value());
  int shift = 0;
  const Errors lossy = run(random, 400, 0.02, [&](int i) {
    shift += random.uniform() < 0.1 ? 1 : 0;
    return (i + shift) * kPeriod_s;
  });
  EXPECT_LT(lossy.taken_s, 1.5 * lossy.raw_s);
  const Errors gap =
      run(random, 400, 0.0, [&](int i) { return i * kPeriod_s + (i < 200 ? 0.0 : 4.037); });
  EXPECT_EQ(gap.changed, 0);
}

}  // namespace
}  // namespace zenith
