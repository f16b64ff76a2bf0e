// When the frames of a recording arrive, and what they say.

#include "drivers/odometry/replayed_can.h"

#include <array>
#include <optional>

#include <gtest/gtest.h>

#include "platform/linux/clock.h"
#include "tests/support/patience.h"
#include "tests/unit/drivers/odometry/frame_bytes.h"

namespace zenith {
namespace {

constexpr Duration kSecond = {1'000'000'000};

std::vector<CanFrame> recording(std::initializer_list<std::int64_t> stamps_ms) {
  std::vector<CanFrame> frames;
  for (const std::int64_t ms : stamps_ms) {
    frames.push_back(frame_of({0x311}, {static_cast<std::uint8_t>(frames.size())}, ms));
  }
  return frames;
}

// A bus that is open before its first frame is due, however slow the computer.
class OpenBus {
 public:
  explicit OpenBus(std::initializer_list<std::int64_t> stamps_ms) {
    const std::int64_t first_ms = *stamps_ms.begin();
    do {
      lead_ = {2 * lead_.ns};
      played_ = monotonic_now() + lead_;
      bus_.emplace(recording(stamps_ms), ReplayTiming{at_ms(first_ms), played_});
      EXPECT_TRUE(bus_->open().ok());
    } while (monotonic_now() >= played_);
  }
  ReplayedCanBus& bus() { return *bus_; }
  Time played() const { return played_; }

 private:
  Duration lead_ = {25'000'000};
  Time played_;
  std::optional<ReplayedCanBus> bus_;
};

TEST(ReplayedCan, FramesArriveWhenTheyWereRecorded) {
  OpenBus opened({7000, 7030, 7060});
  ReplayedCanBus& bus = opened.bus();
  const Time played = opened.played();
  std::array<CanFrame, 8> frames;
  for (std::uint8_t i = 0; i < 3;) {
    const std::size_t taken = bus.receive(kSecond, frames);
    ASSERT_GT(taken, 0u);
    for (std::size_t k = 0; k < taken; ++k, ++i) {
      EXPECT_EQ(frames[k].data[0], i);
      EXPECT_EQ(frames[k].stamp, played + Duration{30'000'000 * i});
      EXPECT_GE(monotonic_now(), frames[k].stamp) << "not before";
    }
  }
  EXPECT_TRUE(bus.finished());
  EXPECT_EQ(bus.receive({1'000'000}, frames), 0u);
  EXPECT_EQ(bus.state(), CanState::kUp) << "silent, not lost";
}

TEST(ReplayedCan, WhatPlayedBeforeOpenIsOver) {
  const Time now = monotonic_now();
  ReplayedCanBus bus(recording({0, 10, 20, 3'600'000}), {at_ms(0), now - kSecond});
  ASSERT_TRUE(bus.open().ok());
  std::array<CanFrame, 8> frames;
  EXPECT_EQ(bus.receive({}, frames), 0u);
  EXPECT_FALSE(bus.finished());
}

TEST(ReplayedCan, StampsThatGoBackAreHeld) {
  OpenBus opened({500, 540, 520, 550});
  ReplayedCanBus& bus = opened.bus();
  const Time played = opened.played();
  std::array<CanFrame, 8> frames;
  std::vector<CanFrame> all;
  const Time end = monotonic_now() + kPatience;
  while (all.size() < 4 && monotonic_now() < end) {
    const std::size_t taken = bus.receive(kSecond, frames);
    all.insert(all.end(), frames.begin(), frames.begin() + taken);
  }
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[2].data[0], 2) << "in order of arrival";
  EXPECT_EQ(all[2].stamp, all[1].stamp);
  EXPECT_EQ(all[3].stamp, played + Duration{50'000'000});
}

}  // namespace
}  // namespace zenith
