#include "slam/map/evidence.h"

#include <cmath>

#include <gtest/gtest.h>

namespace zenith {
namespace {

constexpr HitRates kRates = {0.5, 0.1};
constexpr EvidenceStandard kStandard = {0.5, 10.0, 0.5, 4};

TEST(Evidence, ScoreIsTheLogOddsOfItsWindow) {
  Evidence evidence;
  EXPECT_EQ(evidence.score(kRates), 0.0);
  evidence.add({6, 10});
  evidence.add({0, 4});
  EXPECT_EQ(evidence.searches(), 2);
  EXPECT_EQ(evidence.sum().hits, 6);
  EXPECT_EQ(evidence.sum().expected, 14);
  EXPECT_NEAR(evidence.score(kRates), 6.0 * std::log(0.5 / 0.1) + 8.0 * std::log(0.5 / 0.9), 1e-12);
}

TEST(Evidence, WhatIsMissingOutweighsWhatIsFound) {
  EXPECT_GT(log_odds({5, 10}, kRates), 0.0);
  EXPECT_LT(log_odds({6, 40}, kRates), 0.0) << "six that agree, and thirty-four that are not there";
}

TEST(Evidence, ForgetsAllButTheLastSearches) {
  Evidence evidence;
  for (int i = 0; i < Evidence::kWindow; ++i) evidence.add({10, 10});
  EXPECT_EQ(evidence.sum().hits, 10 * Evidence::kWindow);
  for (int i = 0; i < Evidence::kWindow; ++i) evidence.add({0, 10});
  EXPECT_EQ(evidence.sum().hits, 0);
  EXPECT_EQ(evidence.searches(), 2 * Evidence::kWindow);
}

TEST(Evidence, EachPartOfTheStandardIsNeeded) {
  EXPECT_TRUE(convinces(20.0, 4, 0.6, 0.0, kStandard));
  EXPECT_FALSE(convinces(9.0, 4, 0.6, 0.0, kStandard)) << "score";
  EXPECT_FALSE(convinces(20.0, 3, 0.6, 0.0, kStandard)) << "persistence";
  EXPECT_FALSE(convinces(20.0, 4, 0.4, 0.0, kStandard)) << "confidence";
  EXPECT_FALSE(convinces(20.0, 4, 0.6, 11.0, kStandard)) << "a runner-up";
  EXPECT_TRUE(convinces(20.0, 4, 0.6, -50.0, kStandard)) << "a refuted one is no runner-up";
}

}  // namespace
}  // namespace zenith
