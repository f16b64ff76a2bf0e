// What every CAN bus promises: drivers/odometry/can_bus.h.

#include <array>
#include <memory>

#include <gtest/gtest.h>

#include "tests/contract/allocations.h"
#include "tests/contract/can_bus_rigs.h"
#include "tests/support/patience.h"

namespace zenith {
namespace {

constexpr Duration kShort = {30'000'000};

std::vector<CanFrame> numbered_frames(std::size_t count) {
  std::vector<CanFrame> frames(count);
  for (std::size_t i = 0; i < count; ++i) {
    frames[i].id = i % 3 == 2 ? 0x1B04 : 0x311;
    frames[i].extended = i % 3 == 2;
    frames[i].length = static_cast<std::uint8_t>(2 + i % 7);
    frames[i].data[0] = static_cast<std::uint8_t>(i);
    frames[i].data[1] = static_cast<std::uint8_t>(~i);
  }
  return frames;
}

class CanBusContract : public ::testing::TestWithParam<std::size_t> {
 protected:
  void SetUp() override {
    rig_ = can_bus_rigs()[GetParam()].make();
    if (!rig_->missing().empty()) GTEST_SKIP() << rig_->missing();
  }

  void make(std::vector<CanFrame> frames, const CanIds& ids = {}) {
    sent_ = std::move(frames);
    ids_ = ids;
    bus_ = rig_->make(ids_, sent_);
  }
  void open_once() {
    const Status opened = bus_->open();
    ASSERT_TRUE(opened.ok()) << opened.error().message;
  }
  // A bus that plays from a certain moment on is made anew when that was over before it was open.
  template <typename Open>
  void open_in_time(Open open) {
    open();
    while (rig_->plays_already()) {
      bus_ = rig_->make(ids_, sent_);
      open();
    }
  }
  void open() {
    open_in_time([this] { open_once(); });
  }
  // Until `count` frames are there, `at_once` at most in one call.
  void receive(std::size_t count, std::size_t at_once) {
    const Time end = rig_->now() + kPatience;
    std::array<CanFrame, 64> part;
    while (received_.size() < count && rig_->now() < end) {
      const std::size_t taken = bus_->receive(kShort, {part.data(), at_once});
      ASSERT_LE(taken, at_once);
      received_.insert(received_.end(), part.begin(), part.begin() + taken);
    }
  }
  void expect_sent(const std::vector<CanFrame>& expected) const {
    ASSERT_EQ(received_.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(id_of(received_[i]), id_of(expected[i])) << i;
      EXPECT_EQ(received_[i].length, expected[i].length) << i;
      for (std::size_t byte = 0; byte < expected[i].length; ++byte) {
        EXPECT_EQ(received_[i].data[byte], expected[i].data[byte]) << i;
      }
    }
  }
  // Receives nothing for as long as it takes until the bus is in this state.
  void wait_for(CanState state) {
    const Time end = rig_->now() + kPatience;
    CanFrame frame;
    while (bus_->state() != state && rig_->now() < end) bus_->receive(kShort, {&frame, 1});
    ASSERT_EQ(bus_->state(), state);
  }

  std::unique_ptr<CanBusRig> rig_;
  std::unique_ptr<CanBus> bus_;  // ends before its rig
  std::vector<CanFrame> sent_;
  CanIds ids_;
  std::vector<CanFrame> received_;
};

TEST_P(CanBusContract, ClosedItGivesNothingAtOnce) {
  make(numbered_frames(3));
  EXPECT_EQ(bus_->state(), CanState::kClosed);
  EXPECT_FALSE(bus_->description().empty());
  CanFrame frame;
  const Time start = rig_->now();
  EXPECT_EQ(bus_->receive(kPatience, {&frame, 1}), 0u);
  EXPECT_LT(rig_->now() - start, kPatience);
  bus_->close();
  EXPECT_EQ(bus_->counters().opened, 0u);
}

TEST_P(CanBusContract, FramesArriveWholeAndInOrder) {
  make(numbered_frames(40));
  open();
  EXPECT_EQ(bus_->state(), CanState::kUp);
  EXPECT_STREQ(bus_->lost_reason(), "");
  rig_->send();
  receive(40, 64);
  expect_sent(sent_);
  EXPECT_EQ(bus_->counters().frames, 40u);
  EXPECT_EQ(bus_->counters().dropped, 0u);
}

TEST_P(CanBusContract, WhatDoesNotFitComesWithTheNextCall) {
  make(numbered_frames(20));
  open();
  rig_->send();
  receive(20, 3);
  expect_sent(sent_);
}

TEST_P(CanBusContract, StampsAreThoseOfArrivalAndNeverGoBack) {
  make(numbered_frames(20));
  const Time before = rig_->now();
  open();
  rig_->send();
  receive(20, 7);
  ASSERT_EQ(received_.size(), 20u);
  Time last = before;
  for (const CanFrame& frame : received_) {
    EXPECT_GE(frame.stamp, last);
    last = frame.stamp;
  }
  EXPECT_LE(last, rig_->now());
  EXPECT_EQ(bus_->counters().stamps_replaced, 0u);
}

TEST_P(CanBusContract, OtherIdentifiersDoNotPass) {
  CanIds ids;
  ids.push_back({0x1B04, true});
  ids.push_back({0x7FF});
  make(numbered_frames(12), ids);
  open();
  rig_->send();
  receive(4, 64);
  expect_sent({sent_[2], sent_[5], sent_[8], sent_[11]});
}

TEST_P(CanBusContract, WaitsAsLongAsItsTimeoutAndNotAtAllForZero) {
  make({});
  open();
  CanFrame frame;
  const Time start = rig_->now();
  EXPECT_EQ(bus_->receive(kShort, {&frame, 1}), 0u);
  EXPECT_GE(rig_->now() - start, kShort);
  const Time now = rig_->now();
  EXPECT_EQ(bus_->receive({}, {&frame, 1}), 0u);
  EXPECT_EQ(bus_->receive({-1}, {&frame, 1}), 0u);
  EXPECT_LT(rig_->now() - now, kPatience);
  EXPECT_EQ(bus_->state(), CanState::kUp);
}

TEST_P(CanBusContract, NoRoomIsNoFrame) {
  make(numbered_frames(2));
  open();
  rig_->send();
  EXPECT_EQ(bus_->receive(kShort, {}), 0u);
  receive(2, 64);
  expect_sent(sent_);
}

TEST_P(CanBusContract, OpensAgainAfterCloseAndWhileOpen) {
  make(numbered_frames(5));
  open_in_time([&] {
    open_once();
    bus_->close();
    EXPECT_EQ(bus_->state(), CanState::kClosed);
    open_once();
    open_once();
  });
  EXPECT_EQ(bus_->counters().opened, 3u);
  rig_->send();
  receive(5, 64);
  expect_sent(sent_);
}

TEST_P(CanBusContract, ReceivingTakesNoMemory) {
  make(numbered_frames(10));
  open();
  rig_->send();
  std::array<CanFrame, 16> frames;
  std::size_t taken = 0;
  const Time end = rig_->now() + kPatience;
  const std::uint64_t before = allocation_count();
  while (taken < 10 && rig_->now() < end) taken += bus_->receive(kShort, frames);
  bus_->receive({}, frames);
  EXPECT_EQ(allocation_count(), before);
  EXPECT_EQ(taken, 10u);
}

TEST_P(CanBusContract, BusOffIsAStateThatEnds) {
  if (!rig_->can_fail()) return;  // a recording cannot
  make(numbered_frames(2));
  open();
  rig_->set_bus_off(true);
  wait_for(CanState::kBusOff);
  rig_->set_bus_off(false);
  wait_for(CanState::kUp);
  EXPECT_EQ(bus_->counters().bus_off, 1u);
  EXPECT_EQ(bus_->counters().restarted, 1u);
  rig_->send();
  receive(2, 64);
  expect_sent(sent_);
  EXPECT_EQ(bus_->counters().opened, 1u) << "without open()";
}

TEST_P(CanBusContract, DownItIsLostUntilItIsOpenedAgain) {
  if (!rig_->can_fail()) return;  // a recording cannot
  make(numbered_frames(2));
  open();
  rig_->set_up(false);
  wait_for(CanState::kDown);
  EXPECT_EQ(bus_->counters().lost, 1u);
  EXPECT_STRNE(bus_->lost_reason(), "");
  CanFrame frame;
  EXPECT_EQ(bus_->receive(kPatience, {&frame, 1}), 0u);
  EXPECT_FALSE(bus_->open().ok());
  EXPECT_EQ(bus_->state(), CanState::kClosed);
  rig_->set_up(true);
  open();
  rig_->send();
  receive(2, 64);
  expect_sent(sent_);
  EXPECT_EQ(bus_->counters().lost, 1u);
}

TEST_P(CanBusContract, AShortLossIsNotMissed) {
  if (!rig_->can_fail()) return;  // a recording cannot
  make({});
  open();
  rig_->set_up(false);
  rig_->set_up(true);
  wait_for(CanState::kDown);
  EXPECT_EQ(bus_->counters().lost, 1u);
}

std::string name_of(const ::testing::TestParamInfo<std::size_t>& info) {
  return can_bus_rigs()[info.param].name;
}

INSTANTIATE_TEST_SUITE_P(Buses, CanBusContract,
                         ::testing::Range(std::size_t{0}, can_bus_rigs().size()), name_of);

}  // namespace
}  // namespace zenith
