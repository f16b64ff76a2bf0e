// The SocketCAN bus on this kernel, beyond what all buses promise. Needs $ZENITH_TEST_CAN and root:
// emulated boards have both (tests/hil).

#include <array>
#include <cstdlib>

#include <gtest/gtest.h>

#include "drivers/odometry/socket_can.h"
#include "platform/linux/clock.h"
#include "tests/contract/can_sender.h"

namespace zenith {
namespace {

class VirtualCan : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!sender_.missing().empty()) GTEST_SKIP() << sender_.missing();
  }
  CanSender sender_;
  std::array<CanFrame, 64> out_;
};

can_frame numbered(std::uint32_t number) {
  can_frame frame = {};
  frame.can_id = 0x311;
  frame.can_dlc = 4;
  for (unsigned i = 0; i < 4; ++i) frame.data[i] = static_cast<__u8>(number >> (8 * i));
  return frame;
}

TEST_F(VirtualCan, FramesThatDidNotFitIntoTheQueueAreCounted) {
  constexpr std::uint32_t kSent = 5000;
  SocketCanBus bus({.interface = sender_.interface(), .ids = {}});
  ASSERT_TRUE(bus.open().ok());
  for (std::uint32_t i = 0; i < kSent; ++i) sender_.send(numbered(i));
  std::size_t taken = 0;
  while (const std::size_t count = bus.receive({}, out_)) taken += count;
  ASSERT_LT(taken, kSent) << "the queue held all";
  sender_.send(numbered(kSent));  // carries the sum
  taken += bus.receive({1'000'000'000}, out_);
  EXPECT_EQ(taken + bus.counters().dropped, kSent + 1);
}

TEST_F(VirtualCan, RemoteFramesDoNotPassTheFilter) {
  SocketCanSettings settings = {.interface = sender_.interface(), .ids = {}};
  settings.ids.push_back({0x311});
  SocketCanBus bus(settings);
  ASSERT_TRUE(bus.open().ok());
  can_frame remote = numbered(1);
  remote.can_id |= CAN_RTR_FLAG;
  sender_.send(remote);
  sender_.send(numbered(2));
  ASSERT_EQ(bus.receive({1'000'000'000}, out_), 1u);
  EXPECT_EQ(out_[0].data[0], 2);
  EXPECT_EQ(bus.counters().ignored, 0u);
}

TEST_F(VirtualCan, StampsAreTheKernelsAndNotThoseOfReading) {
  SocketCanBus bus({.interface = sender_.interface(), .ids = {}});
  ASSERT_TRUE(bus.open().ok());
  const Time before = monotonic_now();
  sender_.send(numbered(1));
  const Time after = monotonic_now();
  sleep_until(after + Duration{200'000'000});
  ASSERT_EQ(bus.receive({}, out_), 1u);
  EXPECT_GE(out_[0].stamp, before - CanStamps::kSlack);
  EXPECT_LE(out_[0].stamp, after + CanStamps::kSlack);
  EXPECT_EQ(bus.counters().stamps_replaced, 0u);
}

TEST_F(VirtualCan, AnInterfaceThatIsRemovedAndMadeAgainComesBack) {
  const auto run = [](const char* command) { return std::system(command) == 0; };
  if (!run("ip link add zenithcan type vcan && ip link set zenithcan up")) {
    GTEST_SKIP() << "no interface can be made here";
  }
  SocketCanBus bus({.interface = "zenithcan", .ids = {}});
  const Status opened = bus.open();
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  ASSERT_TRUE(run("ip link del zenithcan"));
  const Time end = monotonic_now() + Duration{10'000'000'000};
  while (bus.state() == CanState::kUp && monotonic_now() < end) bus.receive({10'000'000}, out_);
  EXPECT_EQ(bus.state(), CanState::kDown);
  EXPECT_FALSE(bus.open().ok());
  ASSERT_TRUE(run("ip link add zenithcan type vcan && ip link set zenithcan up"));
  EXPECT_TRUE(bus.open().ok());
  CanSender sender("zenithcan");
  ASSERT_EQ(sender.missing(), "");
  sender.send(numbered(7));
  EXPECT_EQ(bus.receive({1'000'000'000}, out_), 1u);
  EXPECT_TRUE(run("ip link del zenithcan"));
}

TEST_F(VirtualCan, WhatIsNoCanInterfaceIsTold) {
  SocketCanBus bus({.interface = "lo", .ids = {}});
  const Status status = bus.open();
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.error().message.find("no CAN interface"), std::string::npos);
  EXPECT_NE(status.error().message.find(sender_.interface()), std::string::npos);
}

}  // namespace
}  // namespace zenith
