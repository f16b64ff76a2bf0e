#include "platform/daemon/load_shedder.h"

#include "platform/daemon/frame_period.h"

#include <gtest/gtest.h>

namespace zenith {
namespace {

constexpr Duration kPeriod = {100'000'000};
constexpr Duration kBusy = {90'000'000};
constexpr Duration kFair = {60'000'000};
constexpr Duration kCalm = {20'000'000};

TEST(LoadShedder, FallsAtOnceToItsLeastAndComesBackSlowly) {
  LoadShedder shedder;
  shedder.set({0.8, 40, 120});
  EXPECT_EQ(shedder.corners_max(), 120);
  EXPECT_FALSE(shedder.sheds());
  shedder.note(kBusy, kPeriod);
  EXPECT_EQ(shedder.corners_max(), 90);
  EXPECT_TRUE(shedder.sheds());
  for (int i = 0; i < 10; ++i) shedder.note(kBusy, kPeriod);
  EXPECT_EQ(shedder.corners_max(), 40);
  EXPECT_EQ(shedder.frames_shed(), 11u);
  for (int i = 1; i < LoadShedder::kCalm; ++i) shedder.note(kCalm, kPeriod);
  EXPECT_EQ(shedder.corners_max(), 40);
  shedder.note(kFair, kPeriod);  // not calm: begins anew
  for (int i = 1; i < LoadShedder::kCalm; ++i) shedder.note(kCalm, kPeriod);
  EXPECT_EQ(shedder.corners_max(), 40);
  shedder.note(kCalm, kPeriod);
  EXPECT_EQ(shedder.corners_max(), 45);
  for (int i = 0; i < 40 * LoadShedder::kCalm; ++i) shedder.note(kCalm, kPeriod);
  EXPECT_EQ(shedder.corners_max(), 120);
  EXPECT_FALSE(shedder.sheds());
}

// Frames of a camera, one in `every` of which is seen.
void see(FramePeriod& period, Duration interval, int count, std::uint64_t every = 1) {
  static Time stamp = {1'000'000'000};
  static std::uint64_t number = 0;
  for (int i = 0; i < count; ++i) {
    number += every;
    stamp = stamp + Duration{interval.ns * static_cast<std::int64_t>(every)};
    period.note(stamp, number);
  }
}

constexpr Duration kTenth = {100'000'000};
constexpr Duration kThirtieth = {33'333'333};

// 30 a second were asked for, the camera offers 10: a step of 40 ms is quick.
TEST(FramePeriod, ACameraThatIsSlowerThanWishedIsNoReasonToShed) {
  FramePeriod period(kThirtieth);
  EXPECT_EQ(period.value(), kThirtieth) << "nothing is known yet";
  period.begin(kTenth);
  EXPECT_EQ(period.value(), kTenth);
  LoadShedder shedder;
  shedder.set({0.8, 40, 120});
  for (int i = 0; i < 50; ++i) shedder.note({40'000'000}, period.value());
  EXPECT_FALSE(shedder.sheds());
}

// 15 a second were asked for and are what the driver says; 30 come.
TEST(FramePeriod, ACameraThatIsFasterThanItSaysSheds) {
  FramePeriod period({66'666'667});
  period.begin({66'666'667});
  see(period, kThirtieth, static_cast<int>(FramePeriod::kLeast) + 1);
  EXPECT_EQ(period.value(), kThirtieth);
  EXPECT_EQ(period.measured(), kThirtieth);
  EXPECT_EQ(period.agreed(), Duration{66'666'667});
  LoadShedder shedder;
  shedder.set({0.8, 40, 120});
  shedder.note({40'000'000}, period.value());
  EXPECT_TRUE(shedder.sheds());
}

TEST(FramePeriod, FramesThatWerePassedOverDoNotMakeItLonger) {
  FramePeriod period(kTenth);
  period.begin({0});
  EXPECT_EQ(period.value(), kTenth) << "the driver does not say";
  see(period, kThirtieth, 30, 4);
  EXPECT_EQ(period.value(), kThirtieth);
  // Some odd stamps, and numbers that do not rise, change nothing.
  see(period, {1}, 4);
  see(period, {5'000'000'000}, 2);
  period.note({7}, 1);
  period.note({8}, 0);
  EXPECT_EQ(period.value(), kThirtieth);
  // A camera that takes its time in the dark.
  see(period, kTenth, static_cast<int>(FramePeriod::kIntervals));
  EXPECT_EQ(period.value(), kTenth);
}

TEST(FramePeriod, ACameraThatIsOpenedAgainIsMeasuredAnew) {
  FramePeriod period(kTenth);
  period.begin(kTenth);
  see(period, kTenth, 20);
  period.begin(kThirtieth);
  EXPECT_EQ(period.value(), kThirtieth);
  EXPECT_EQ(period.measured(), Duration{0});
}

TEST(LoadShedder, FollowsNewLimits) {
  LoadShedder shedder;
  shedder.set({0.8, 40, 120});
  shedder.set({0.8, 40, 60});
  EXPECT_EQ(shedder.corners_max(), 60);
  EXPECT_FALSE(shedder.sheds());
  shedder.set({0.8, 40, 100});
  EXPECT_EQ(shedder.corners_max(), 100);
  for (int i = 0; i < 10; ++i) shedder.note(kBusy, kPeriod);
  shedder.set({0.8, 50, 100});
  EXPECT_EQ(shedder.corners_max(), 50);
  shedder.set({0.8, 90, 30});  // the least is never above the most
  EXPECT_EQ(shedder.corners_max(), 30);
}

}  // namespace
}  // namespace zenith
