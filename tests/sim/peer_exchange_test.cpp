// Whole robots, datagram by datagram: who is let in, what a new boot, a goodbye, a repetition and
// faults do.

#include "platform/link/peer_exchange.h"

#include <gtest/gtest.h>

#include "tests/sim/exchange_fleet.h"
#include "tests/support/seeds.h"

namespace zenith::exchange {
namespace {

void tell(Fleet& fleet, int node, std::uint32_t count) {
  for (std::uint32_t id = 1; id <= count; ++id) {
    fleet.node(node).set(made_up_record(fleet.random, id, 1));
  }
}

TEST(PeerExchange, ThreeRobotsGetEachOthersMaps) {
  const TestSeed seed;
  Fleet fleet(3, seed.value());
  for (int i = 0; i < 3; ++i) tell(fleet, i, 200);
  EXPECT_LT(fleet.run_until_same(15.0), 15.0) << fleet.first_difference();
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(fleet.node(i).rejected(Rejected::kForged), 0u);
    EXPECT_EQ(fleet.node(i).rejected(Rejected::kMalformed), 0u);
    EXPECT_EQ(fleet.node(i).link().sessions().counters().verified, 2u);
  }
}

class PeerExchangeOfTwo : public testing::Test {
 protected:
  const TestSeed seed;
  Fleet fleet{2, seed.value()};
  FleetNode& ada = fleet.node(0);
  FleetNode& bert = fleet.node(1);
};

// An answer that waits is due at once: the network asks for nothing that is not promised.
TEST_F(PeerExchangeOfTwo, PromisesItsAnswers) {
  sim::Datagram hello;
  const Time now = at(0);
  ASSERT_TRUE(bert.send(now, hello));
  sim::Datagram state;
  while (ada.send(now, state)) continue;
  ASSERT_GT(ada.link().next_time(now), now);
  ada.receive(now, 1, hello.bytes);
  EXPECT_EQ(ada.link().next_time(now), now);
}

TEST_F(PeerExchangeOfTwo, APeerThatBeginsAnewIsAnotherMap) {
  tell(fleet, 1, 50);
  fleet.network.run_for(8.0);
  const int before = ada.slot_of(bert);
  ASSERT_GE(before, 0);
  const std::uint32_t old_map = bert.map();
  EXPECT_EQ(ada.replica(bert)->size(), 50u);

  bert.restart(777);
  tell(fleet, 1, 20);
  fleet.network.run_for(8.0);
  ASSERT_GE(ada.slot_of(bert), 0);
  EXPECT_NE(ada.slot_of(bert), before);
  EXPECT_EQ(ada.replica(bert)->size(), 20u);
  ASSERT_EQ(ada.slot_of(bert.robot(), old_map), before) << "as long as there is room it stays";
  EXPECT_EQ(ada.replica(bert.robot(), old_map)->size(), 50u);
}

TEST_F(PeerExchangeOfTwo, ByeEndsTheSessionAndTheMapStays) {
  tell(fleet, 1, 30);
  fleet.network.run_for(8.0);
  const int slot = ada.slot_of(bert);
  ASSERT_GE(slot, 0);
  bert.sync().say_bye();
  fleet.network.run_for(0.1);
  EXPECT_EQ(ada.link().sessions().find_peer(bert.robot()), -1);
  EXPECT_EQ(ada.sync().peer(slot).session, -1);
  EXPECT_EQ(ada.replica(bert)->size(), 30u);
}

// All that was ever said, said again, from elsewhere: nothing changes.
TEST_F(PeerExchangeOfTwo, ReplayedTrafficChangesNothing) {
  ada.keeps_sent = bert.keeps_sent = true;
  tell(fleet, 1, 60);
  fleet.network.run_for(8.0);
  ASSERT_NE(ada.replica(bert), nullptr);
  const RecordMap map = *ada.replica(bert);
  const auto before = ada.link().sessions().counters();
  std::uint64_t replayed = 0;
  for (const FleetNode* sender : {&ada, &bert}) {
    for (const Datagram& datagram : sender->sent) {
      ada.link().receive(fleet.network.now(), address_of(66), datagram, ada);
      ++replayed;
    }
  }
  const auto& after = ada.link().sessions().counters();
  EXPECT_EQ(after.received, before.received);
  std::uint64_t rejected = 0;
  for (std::size_t i = 0; i < kRejectedKinds; ++i) {
    rejected += after.rejected[i] - before.rejected[i];
  }
  EXPECT_EQ(rejected, replayed);
  EXPECT_EQ(ada.replica(bert)->size(), map.size());
  const int session = ada.link().sessions().find_peer(bert.robot());
  EXPECT_EQ(ada.link().sessions().session(session)->address, bert.address());
}

TEST_F(PeerExchangeOfTwo, ARobotThatKeepsMakingFaultsIsQuarantined) {
  tell(fleet, 1, 30);
  fleet.network.run_for(8.0);
  ASSERT_GE(ada.slot_of(bert), 0);
  std::array<std::uint8_t, kMaxDatagramBytes> datagram;
  for (int i = 0; i < 4; ++i) {
    const std::vector<std::uint8_t> cut = {5, 200, 0, 1, 2, 3};
    const std::size_t size = bert.link().sessions().seal(cut, datagram);
    ada.link().receive(fleet.network.now(), bert.address(), std::span(datagram).first(size), ada);
  }
  EXPECT_EQ(ada.rejected(Rejected::kMalformed), 3u);
  EXPECT_EQ(ada.rejected(Rejected::kQuarantined), 1u);
  bool told = false;
  for (LinkEvent event; ada.link().sessions().next_event(event);) {
    told = told || event.kind == LinkEventKind::kQuarantined;
  }
  EXPECT_TRUE(told);
}

}  // namespace
}  // namespace zenith::exchange
