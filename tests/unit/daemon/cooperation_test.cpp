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

}  // namespace
}  // namespace zenith
