#include "platform/daemon/load_shedder.h"

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
