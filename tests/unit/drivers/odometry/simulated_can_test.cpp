// The simulated bus between two threads, and when it is full.

#include "drivers/odometry/simulated_can.h"

#include <array>
#include <thread>

#include <gtest/gtest.h>

namespace zenith {
namespace {

CanFrame numbered(std::uint32_t number) {
  CanFrame frame;
  frame.id = 0x311;
  frame.length = 4;
  for (std::size_t i = 0; i < 4; ++i) frame.data[i] = static_cast<std::uint8_t>(number >> (8 * i));
  return frame;
}

std::uint32_t number_of(const CanFrame& frame) {
  std::uint32_t number = 0;
  for (std::size_t i = 4; i > 0; --i) number = number << 8U | frame.data[i - 1];
  return number;
}

TEST(SimulatedCan, LosesNothingUncountedBetweenTwoThreads) {
  constexpr std::uint32_t kSent = 50'000;
  SimulatedCanBus bus;
  ASSERT_TRUE(bus.open().ok());
  std::thread sender([&bus] {
    for (std::uint32_t i = 0; i < kSent; ++i) bus.send(numbered(i));
  });
  std::array<CanFrame, 32> frames;
  std::uint64_t taken = 0;
  std::int64_t last = -1;
  const auto take = [&](Duration timeout) {
    const std::size_t count = bus.receive(timeout, frames);
    for (std::size_t i = 0; i < count; ++i) {
      const auto number = std::int64_t{number_of(frames[i])};
      EXPECT_GT(number, last);
      last = number;
    }
    taken += count;
    return count;
  };
  while (taken + bus.counters().dropped < kSent / 2) take({1'000'000});
  sender.join();
  while (take({}) > 0) {
  }
  EXPECT_EQ(taken + bus.counters().dropped, kSent);
  EXPECT_EQ(bus.counters().frames, taken);
}

TEST(SimulatedCan, AFullQueueDropsTheNewestAndCountsThem) {
  SimulatedCanBus bus;
  ASSERT_TRUE(bus.open().ok());
  for (std::uint32_t i = 0; i < SimulatedCanBus::kCapacity + 9; ++i) bus.send(numbered(i));
  std::array<CanFrame, SimulatedCanBus::kCapacity + 9> frames;
  ASSERT_EQ(bus.receive({}, frames), SimulatedCanBus::kCapacity);
  EXPECT_EQ(number_of(frames[SimulatedCanBus::kCapacity - 1]), SimulatedCanBus::kCapacity - 1);
  EXPECT_EQ(bus.counters().dropped, 9u);
  bus.send(numbered(1));
  ASSERT_TRUE(bus.open().ok()) << "forgets what lay there";
  EXPECT_EQ(bus.receive({}, frames), 0u);
  EXPECT_EQ(bus.counters().dropped, 9u);
}

TEST(SimulatedCan, NothingArrivesWhileClosedOffOrDown) {
  SimulatedCanBus bus;
  std::array<CanFrame, 4> frames;
  bus.send(numbered(1));
  ASSERT_TRUE(bus.open().ok());
  bus.set_bus_off(true);
  bus.send(numbered(2));
  bus.set_bus_off(false);
  bus.send(numbered(3));
  ASSERT_EQ(bus.receive({}, frames), 1u);
  EXPECT_EQ(number_of(frames[0]), 3u);
  EXPECT_EQ(bus.counters().bus_off, 1u) << "short as it was";
  bus.set_up(false);
  bus.send(numbered(4));
  EXPECT_EQ(bus.receive({}, frames), 0u);
  EXPECT_EQ(bus.state(), CanState::kDown);
}

}  // namespace
}  // namespace zenith
