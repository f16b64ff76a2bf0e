#include "platform/daemon/cooperation.h"

#include <memory>

#include <gtest/gtest.h>

#include "platform/daemon/radio_link.h"

namespace zenith {
namespace {

TEST(Cooperation, AloneItCountsWhatNobodyHears) {
  const auto exchange = std::make_unique<Exchange>();
  Cooperation cooperation(*exchange, nullptr);
  exchange->own.push({});
  cooperation.turn_once({});
  EXPECT_EQ(exchange->own.size(), 0u);
  EXPECT_EQ(cooperation.counters().unheard, 1u);
  EXPECT_FALSE(cooperation.has_link());
  LinkStatus status;
  EXPECT_FALSE(cooperation.read(status));
}

// Whoever shows the maps may sleep: peers, checkpoints and perception do not wait for it.
TEST(Cooperation, WhatIsShownHoldsNothingUp) {
  const auto exchange = std::make_unique<Exchange>();
  Cooperation cooperation(*exchange, nullptr);
  constexpr std::uint32_t kMany = 20'000;
  for (std::uint32_t id = 1; id <= kMany; ++id) {
    LandmarkRecord record;
    record.id = id;
    exchange->own.push(record);
    if (id % 500 == 0) cooperation.turn_once({});
  }
  EXPECT_EQ(exchange->own.size(), 0u);
  EXPECT_EQ(exchange->own.rejected(), 0u);
  EXPECT_EQ(cooperation.counters().unheard, kMany);
}

}  // namespace
}  // namespace zenith
