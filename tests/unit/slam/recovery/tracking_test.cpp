// When a frame is taken not to be of where the robot is.

#include "slam/recovery/tracking.h"

#include <gtest/gtest.h>

namespace zenith {
namespace {

TEST(Tracking, AFrameInWhichAlmostNothingIsFoundIsWeak) {
  EXPECT_TRUE(Tracking::is_weak({30, 2, 80, 4}));
  EXPECT_TRUE(Tracking::is_weak({30, 9, 80, 12}));
}

TEST(Tracking, WhereLittleIsExpectedNothingIsSaid) {
  EXPECT_FALSE(Tracking::is_weak({9, 0, 40, 0}));
}

TEST(Tracking, AFairPartOfAllThatAgreesIsNoChance) {
  // The reliable ones are of another part of the map; what was mapped lately agrees.
  EXPECT_FALSE(Tracking::is_weak({16, 4, 48, 18}));
  EXPECT_FALSE(Tracking::is_weak({13, 4, 34, 12}));
  // Of few landmarks a part agrees by chance.
  EXPECT_TRUE(Tracking::is_weak({12, 3, 20, 7}));
}

TEST(Tracking, WhatNoiseShowsByAccidentIsNoFairPart) {
  // A white ceiling, of whose landmarks two are real; then wheels that jerked by 2 and 4 degrees.
  EXPECT_FALSE(Tracking::is_fair_part({2, 1, 174, 28}));
  EXPECT_FALSE(Tracking::is_fair_part({4, 2, 170, 34}));
  EXPECT_TRUE(Tracking::is_fair_part({60, 24, 87, 27}));
  EXPECT_TRUE(Tracking::is_fair_part({56, 29, 76, 31}));
}

}  // namespace
}  // namespace zenith
