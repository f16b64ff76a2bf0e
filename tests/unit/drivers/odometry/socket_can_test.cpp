#include "drivers/odometry/socket_can.h"

#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/drivers/odometry/fake_can.h"

namespace zenith {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr Duration ms(std::int64_t count) {
  return {count * 1'000'000};
}

class SocketCan : public ::testing::Test {
 protected:
  void SetUp() override { kernel_.plug("can0"); }

  std::string open_error(SocketCanBus& bus) {
    const Status status = bus.open();
    EXPECT_EQ(bus.state(), status.ok() ? CanState::kUp : CanState::kClosed);
    return status.ok() ? "opened" : status.error().message;
  }
  std::size_t receive(Duration timeout = {}) { return bus_.receive(timeout, out_); }
  void error_frame(canid_t what) {
    kernel_.send("can0", raw_can(CAN_ERR_FLAG | what, {0, 0, 0, 0, 0, 0, 0, 0}));
  }
  void data_frame(std::uint8_t value = 0) { kernel_.send("can0", raw_can(0x311, {value})); }

  FakeCan kernel_;
  SocketCanBus bus_{{}, kernel_};
  std::array<CanFrame, 8> out_;
};

TEST_F(SocketCan, DeliversFramesByteExactly) {
  ASSERT_EQ(open_error(bus_), "opened");
  kernel_.send("can0", raw_can(0x311, {0x01, 0x23, 0x45, 0x67, 0x89, 0xAB, 0xCD, 0xEF}));
  kernel_.send("can0", raw_can(CAN_EFF_FLAG | 0x1B04, {0xFE, 0x80}));
  kernel_.send("can0", raw_can(0x7FF, {}));
  ASSERT_EQ(receive(), 3u);
  EXPECT_EQ(id_of(out_[0]), CanId{0x311});
  EXPECT_EQ(out_[0].length, 8);
  EXPECT_EQ(out_[0].data,
            (std::array<std::uint8_t, 8>{1, 0x23, 0x45, 0x67, 0x89, 0xAB, 0xCD, 0xEF}));
  EXPECT_EQ(id_of(out_[1]), (CanId{0x1B04, true}));
  EXPECT_EQ(out_[1].length, 2);
  EXPECT_EQ(out_[1].data, (std::array<std::uint8_t, 8>{0xFE, 0x80}));
  EXPECT_EQ(id_of(out_[2]), CanId{0x7FF});
  EXPECT_EQ(out_[2].length, 0);
}

TEST_F(SocketCan, TheKernelFiltersIdentifiersOfBothLengths) {
  SocketCanSettings settings;
  settings.ids.push_back({0x311});
  settings.ids.push_back({0x221, true});
  SocketCanBus bus(settings, kernel_);
  ASSERT_EQ(open_error(bus), "opened");
  for (const canid_t id : {0x311U, 0x311U | CAN_EFF_FLAG, 0x311U | CAN_RTR_FLAG, 0x221U,
                           0x221U | CAN_EFF_FLAG, 0x310U, 0x10000221U | CAN_EFF_FLAG}) {
    kernel_.send("can0", raw_can(id, {}));
  }
  ASSERT_EQ(bus.receive({}, out_), 2u);
  EXPECT_EQ(id_of(out_[0]), CanId{0x311});
  EXPECT_EQ(id_of(out_[1]), (CanId{0x221, true}));
  EXPECT_EQ(bus.counters().ignored, 0u) << "nothing else reaches the program";
}

TEST_F(SocketCan, OldFramesKeepTheMomentOfTheirReception) {
  ASSERT_EQ(open_error(bus_), "opened");
  EXPECT_EQ(receive(), 0u);
  const Time sent = kernel_.now() + ms(3);
  kernel_.send_at(sent, "can0", raw_can(0x311, {}));
  kernel_.send_at(sent + ms(4), "can0", raw_can(0x311, {}));
  kernel_.advance(ms(50));
  ASSERT_EQ(receive(), 2u);
  EXPECT_EQ(out_[0].stamp, sent);
  EXPECT_EQ(out_[1].stamp, sent + ms(4));
  EXPECT_EQ(bus_.counters().stamps_replaced, 0u);
}

TEST_F(SocketCan, AStepOfTheWallClockChangesNothing) {
  ASSERT_EQ(open_error(bus_), "opened");
  for (const Duration step : {ms(-86'400'000), ms(3'000), ms(3600'000), ms(-700)}) {
    EXPECT_EQ(receive(), 0u);
    const Time before = kernel_.now();
    data_frame();
    kernel_.step_wall_clock(step);  // between reception and reading
    kernel_.advance(ms(5));
    const std::uint64_t replaced = bus_.counters().stamps_replaced;
    ASSERT_EQ(receive(), 1u);
    EXPECT_GE(out_[0].stamp, before - Duration{10'000}) << "the queue was seen empty just before";
    EXPECT_LE(out_[0].stamp, kernel_.now());
    EXPECT_EQ(bus_.counters().stamps_replaced, replaced + 1);
    data_frame();
    const Time sent = kernel_.now();
    kernel_.advance(ms(5));
    ASSERT_EQ(receive(), 1u);
    EXPECT_EQ(out_[0].stamp, sent) << "both clocks are read again for each frame";
    EXPECT_EQ(bus_.counters().stamps_replaced, replaced + 1);
  }
}

// The kernel stamped it, was held up, and we saw an empty queue in between.
TEST_F(SocketCan, AFrameThatIsHandedOverLateKeepsItsStamp) {
  ASSERT_EQ(open_error(bus_), "opened");
  std::int64_t late_ns = 0;
  kernel_.spoil = [&](CanDatagram& datagram) { *datagram.stamp_ns -= late_ns; };
  for (const auto& [ms_late, replaced] : {std::pair{15, 0u}, std::pair{30, 1u}}) {
    kernel_.advance(ms(100));
    EXPECT_EQ(receive(), 0u);
    late_ns = ms(ms_late).ns;
    data_frame();
    const Time handed_over = kernel_.now();
    ASSERT_EQ(receive(), 1u);
    EXPECT_EQ(out_[0].stamp == handed_over - ms(ms_late), replaced == 0);
    EXPECT_EQ(bus_.counters().stamps_replaced, replaced);
  }
}

// Held up for too long to be believed; those behind it are, and stay apart from it.
TEST_F(SocketCan, AStampThatIsTooOldLeavesRoomForThoseBehindIt) {
  ASSERT_EQ(open_error(bus_), "opened");
  EXPECT_EQ(receive(), 0u);
  const Time empty = kernel_.now();
  kernel_.spoil = [&](CanDatagram& datagram) {
    if (kernel_.now() < empty + ms(10)) *datagram.stamp_ns -= ms(60).ns;
  };
  kernel_.send_at(empty + ms(5), "can0", raw_can(0x311, {}));
  kernel_.send_at(empty + ms(20), "can0", raw_can(0x311, {}));
  kernel_.advance(ms(30));
  ASSERT_EQ(receive(), 2u);
  EXPECT_LE(out_[0].stamp, empty);
  EXPECT_GE(out_[0].stamp, empty - Duration{10'000});
  EXPECT_EQ(out_[1].stamp, empty + ms(20));
  EXPECT_EQ(bus_.counters().stamps_replaced, 1u);
}

TEST_F(SocketCan, StampsFromNowhereOrNoneAreReplaced) {
  ASSERT_EQ(open_error(bus_), "opened");
  Time last = kernel_.now();
  for (const std::optional<std::int64_t> stamp :
       {std::optional<std::int64_t>{}, std::optional<std::int64_t>{0},
        std::optional<std::int64_t>{INT64_MIN}, std::optional<std::int64_t>{INT64_MAX}}) {
    kernel_.spoil = [&](CanDatagram& datagram) { datagram.stamp_ns = stamp; };
    kernel_.advance(ms(10));
    data_frame();
    ASSERT_EQ(receive(), 1u);
    EXPECT_GT(out_[0].stamp, last);
    EXPECT_LE(out_[0].stamp, kernel_.now());
    last = out_[0].stamp;
  }
  EXPECT_EQ(bus_.counters().stamps_replaced, 4u);
}

TEST_F(SocketCan, StampsNeverGoBack) {
  ASSERT_EQ(open_error(bus_), "opened");
  int number = 0;
  kernel_.spoil = [&](CanDatagram& datagram) { *datagram.stamp_ns -= ++number % 2 * 800'000; };
  Time last;
  for (int i = 0; i < 20; ++i) {
    data_frame();
    ASSERT_EQ(receive(), 1u);
    EXPECT_GE(out_[0].stamp, last);
    last = out_[0].stamp;
  }
}

TEST_F(SocketCan, CountsWhatTheKernelDroppedAlsoOverTheWrapOfItsSum) {
  ASSERT_EQ(open_error(bus_), "opened");
  for (std::size_t i = 0; i < FakeCan::kQueue + 7; ++i) data_frame();
  std::size_t taken = 0;
  while (const std::size_t count = receive()) taken += count;
  EXPECT_EQ(taken, FakeCan::kQueue);
  data_frame();  // carries the sum
  receive();
  EXPECT_EQ(bus_.counters().dropped, 7u);
  std::uint32_t sum = 0xFFFFFFFEU;
  kernel_.spoil = [&](CanDatagram& datagram) { datagram.drops_sum = sum; };
  SocketCanBus wrapping({}, kernel_);
  ASSERT_EQ(open_error(wrapping), "opened");
  data_frame();
  wrapping.receive({}, out_);
  const std::uint64_t before = wrapping.counters().dropped;
  sum = 3;
  data_frame();
  wrapping.receive({}, out_);
  EXPECT_EQ(wrapping.counters().dropped, before + 5);
}

TEST_F(SocketCan, BusOffIsAStateAndTheControllerTellsItsEnd) {
  ASSERT_EQ(open_error(bus_), "opened");
  error_frame(CAN_ERR_CRTL);
  EXPECT_EQ(receive(), 0u);
  EXPECT_EQ(bus_.state(), CanState::kUp);
  error_frame(CAN_ERR_BUSOFF);
  error_frame(CAN_ERR_BUSOFF);
  EXPECT_EQ(receive(), 0u);
  EXPECT_EQ(bus_.state(), CanState::kBusOff);
  error_frame(CAN_ERR_RESTARTED);
  EXPECT_EQ(receive(), 0u);
  EXPECT_EQ(bus_.state(), CanState::kUp);
  EXPECT_EQ(bus_.counters().error_frames, 4u);
  EXPECT_EQ(bus_.counters().bus_off, 1u);
  EXPECT_EQ(bus_.counters().restarted, 1u);
}

TEST_F(SocketCan, AFrameAfterBusOffShowsThatItIsOver) {
  ASSERT_EQ(open_error(bus_), "opened");
  error_frame(CAN_ERR_BUSOFF);
  data_frame();
  EXPECT_EQ(receive(), 1u);
  EXPECT_EQ(bus_.state(), CanState::kUp);
  EXPECT_EQ(bus_.counters().bus_off, 1u);
  EXPECT_EQ(bus_.counters().restarted, 1u);
}

TEST_F(SocketCan, AFloodOfErrorFramesDoesNotHoldTheCallerUp) {
  ASSERT_EQ(open_error(bus_), "opened");
  for (int i = 0; i < 90; ++i) error_frame(CAN_ERR_BUSERROR);
  data_frame();
  EXPECT_EQ(receive(), 0u);
  EXPECT_EQ(bus_.counters().error_frames, std::uint64_t{SocketCanBus::kMaxOther});
  EXPECT_EQ(receive(), 1u) << "the frame comes when the flood is over";
}

TEST_F(SocketCan, ErrorFramesDoNotEndTheWaitForAFrame) {
  ASSERT_EQ(open_error(bus_), "opened");
  const Time start = kernel_.now();
  kernel_.send_at(start + ms(2), "can0", raw_can(CAN_ERR_FLAG | CAN_ERR_CRTL, {}));
  kernel_.send_at(start + ms(5), "can0", raw_can(0x311, {}));
  EXPECT_EQ(receive(ms(20)), 1u);
  EXPECT_EQ(out_[0].stamp, start + ms(5));
}

TEST_F(SocketCan, IgnoresRemoteFramesAndWhatIsNoClassicFrame) {
  ASSERT_EQ(open_error(bus_), "opened");
  kernel_.send("can0", raw_can(CAN_RTR_FLAG | 0x311, {}));
  can_frame longer = raw_can(0x311, {});
  longer.can_dlc = 9;
  kernel_.send("can0", longer);
  kernel_.spoil = [](CanDatagram& datagram) { datagram.bytes = 8; };
  data_frame();
  EXPECT_EQ(receive(), 0u);
  EXPECT_EQ(bus_.counters().ignored, 3u);
}

TEST_F(SocketCan, AnInterfaceThatGoesDownIsLostAndComesBack) {
  ASSERT_EQ(open_error(bus_), "opened");
  kernel_.set_up("can0", false);
  EXPECT_EQ(receive(ms(1000)), 0u);
  EXPECT_EQ(bus_.state(), CanState::kDown);
  EXPECT_THAT(bus_.lost_reason(), HasSubstr("went down"));
  const Time then = kernel_.now();
  EXPECT_EQ(receive(ms(1000)), 0u);
  EXPECT_EQ(kernel_.now(), then) << "it does not wait for what is lost";
  EXPECT_THAT(open_error(bus_), AllOf(HasSubstr("can0 is down"), HasSubstr("ip link set can0 up")));
  kernel_.set_up("can0", true);
  ASSERT_EQ(open_error(bus_), "opened");
  EXPECT_STREQ(bus_.lost_reason(), "");
  data_frame();
  EXPECT_EQ(receive(), 1u);
  EXPECT_EQ(bus_.counters().lost, 1u);
  EXPECT_EQ(bus_.counters().opened, 2u);
}

TEST_F(SocketCan, AnAdapterThatIsPluggedInAgainHasAnotherIndex) {
  ASSERT_EQ(open_error(bus_), "opened");
  data_frame();
  kernel_.unplug("can0");
  while (bus_.state() == CanState::kUp) receive(ms(10));
  EXPECT_EQ(bus_.state(), CanState::kDown);
  EXPECT_THAT(bus_.lost_reason(), HasSubstr("is gone"));
  kernel_.plug("can1");
  EXPECT_THAT(open_error(bus_), AllOf(HasSubstr("can0: there is none"), HasSubstr("can1")));
  kernel_.plug("can0");
  ASSERT_EQ(open_error(bus_), "opened");
  data_frame();
  EXPECT_EQ(receive(), 1u);
}

TEST_F(SocketCan, EveryRefusalOfTheKernelIsToldAndLeavesNoSocket) {
  for (const auto& [option, text] :
       std::map<int, const char*>{{CAN_RAW_FILTER, "filter of identifiers"},
                                  {CAN_RAW_ERR_FILTER, "error frames"},
                                  {SO_TIMESTAMPNS, "reception stamps"},
                                  {SO_RXQ_OVFL, "dropped frames"}}) {
    kernel_.failing_options = {{option, ENOPROTOOPT}};
    EXPECT_THAT(open_error(bus_), AllOf(HasSubstr(text), HasSubstr("ENOPROTOOPT")));
    EXPECT_EQ(kernel_.open_sockets, 0);
  }
  kernel_.failing_options.clear();
  kernel_.open_error = EAFNOSUPPORT;
  EXPECT_THAT(open_error(bus_), HasSubstr("modprobe can_raw"));
  kernel_.open_error = EPERM;
  EXPECT_THAT(open_error(bus_), HasSubstr("RestrictAddressFamilies="));
  kernel_.open_error = 0;
  SocketCanBus nameless({.interface = "a name too long", .ids = {}}, kernel_);
  EXPECT_THAT(open_error(nameless), HasSubstr("there is none"));
  SocketCanBus longer({.interface = "a name far too long", .ids = {}}, kernel_);
  EXPECT_THAT(open_error(longer), HasSubstr("1 to 15 characters"));
  EXPECT_EQ(bus_.counters().opened, 0u);
}

TEST_F(SocketCan, APollThatOnlyReportsErrorsIsALossAndNoEndlessLoop) {
  ASSERT_EQ(open_error(bus_), "opened");
  kernel_.poll_events = POLLERR;
  EXPECT_EQ(receive(ms(1000)), 0u);
  EXPECT_EQ(bus_.state(), CanState::kDown);
  EXPECT_STRNE(bus_.lost_reason(), "");
}

TEST_F(SocketCan, ItsEndClosesTheSocket) {
  {
    SocketCanBus bus({}, kernel_);
    ASSERT_EQ(open_error(bus), "opened");
    ASSERT_EQ(open_error(bus), "opened");
    EXPECT_EQ(kernel_.open_sockets, 1);
  }
  EXPECT_EQ(kernel_.open_sockets, 0);
}

// Whatever this kernel offers, an interface that does not exist is told.
TEST(KernelCanIo, TellsThatAnInterfaceIsMissing) {
  SocketCanBus bus({.interface = "zenith-none", .ids = {}});
  const Status status = bus.open();
  ASSERT_FALSE(status.ok());
  EXPECT_THAT(status.error().message, HasSubstr("zenith-none: there is none"));
  const CanClocks clocks = kernel_can_io().clocks();
  EXPECT_NEAR(static_cast<double>((kernel_can_io().now() - clocks.monotonic).ns), 0.0, 1e9);
  EXPECT_GT(clocks.realtime_ns, 1'600'000'000'000'000'000);
}

}  // namespace
}  // namespace zenith
