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

// Somebody with the key who takes bert's name and makes faults.
class TakenName : public PeerExchangeOfTwo {
 protected:
  void SetUp() override {
    tell(fleet, 1, 30);
    fleet.network.run_for(8.0);
    ASSERT_NE(ada.replica(bert), nullptr);
    ASSERT_EQ(ada.replica(bert)->size(), 30u);
  }
  // Verified as bert, with a boot of its own; then three faults.
  void misbehave(std::uint64_t boot) {
    TestRobot mallory(session_settings(bert.name(), boot), 66);
    hear(mallory, mallory.hello());
    for (const Datagram& challenge : ada_answers()) mallory.hear(now(), ada.address(), challenge);
    for (const auto& [to, response] : mallory.answers()) hear(mallory, response);
    const int slot = ada.link().sessions().find_peer(bert.robot());
    ASSERT_GE(slot, 0);
    ASSERT_EQ(ada.link().sessions().session(slot)->id.boot, boot) << "mallory is not even heard";
    for (int i = 0; i < 3; ++i) hear(mallory, mallory.say({5, 200, 0, 1, 2, 3}));
  }
  void hear(const TestRobot& speaker, const Datagram& datagram) {
    ada.link().receive(now(), speaker.address, datagram, ada);
  }
  std::vector<Datagram> ada_answers() {
    std::vector<Datagram> all;
    std::array<std::uint8_t, kMaxDatagramBytes> room;
    for (Dispatch d = ada.link().next(now(), room); d.size > 0; d = ada.link().next(now(), room)) {
      if (d.to_everybody) continue;
      all.emplace_back(room.begin(), room.begin() + static_cast<std::ptrdiff_t>(d.size));
    }
    return all;
  }
  Time now() const { return fleet.network.now(); }
  void expect_bert_is_heard() {
    ASSERT_NE(ada.replica(bert), nullptr) << "his map was withdrawn";
    EXPECT_EQ(ada.replica(bert)->size(), bert.own().size());
    EXPECT_TRUE(ada.complete(bert));
    const int slot = ada.link().sessions().find_peer(bert.robot());
    ASSERT_GE(slot, 0);
    EXPECT_EQ(ada.link().sessions().session(slot)->id, bert.link().sessions().own());
    EXPECT_FALSE(ada.sync().quarantined(now(), slot));
  }
};

TEST_F(TakenName, TheHonestRobotIsHeardAgainOnceTheOtherIsQuarantined) {
  misbehave(777'777);
  EXPECT_EQ(ada.sync().counters().quarantines, 1u);
  bert.set(made_up_record(fleet.random, 99, 1));
  fleet.network.run_for(5.0);
  expect_bert_is_heard();
}

TEST_F(TakenName, TheHonestRobotsNextBootIsHeardAtOnce) {
  misbehave(777'777);
  bert.restart(4242);
  tell(fleet, 1, 20);
  fleet.network.run_for(6.0);
  expect_bert_is_heard();
}

TEST_F(TakenName, AgainAndAgain) {
  for (std::uint64_t i = 0; i < 100; ++i) {
    misbehave(800'000 + i);
    fleet.network.run_for(2.0);
  }
  fleet.network.run_for(5.0);
  expect_bert_is_heard();
}

// Bert's faults are bert's: his next boot begins without them, and is quarantined for its own.
TEST_F(TakenName, ARobotThatIsBrokenIsQuarantinedInEachBoot) {
  for (int boot = 0; boot < 3; ++boot) {
    std::array<std::uint8_t, kMaxDatagramBytes> datagram;
    for (int i = 0; i < 3; ++i) {
      const std::vector<std::uint8_t> cut = {5, 200, 0, 1, 2, 3};
      const std::size_t size = bert.link().sessions().seal(cut, datagram);
      ada.link().receive(now(), bert.address(), std::span(datagram).first(size), ada);
    }
    const int slot = ada.link().sessions().find_peer(bert.robot());
    ASSERT_GE(slot, 0);
    EXPECT_TRUE(ada.sync().quarantined(now(), slot));
    EXPECT_EQ(ada.replica(bert), nullptr);
    bert.restart(static_cast<std::uint32_t>(5000 + boot));
    tell(fleet, 1, 20);
    fleet.network.run_for(12.0);
    expect_bert_is_heard();
  }
}

// With the key somebody can even speak as bert's own boot. When the fleet has changed its key, what
// was done with the old one is not held against him.
TEST_F(TakenName, ANewKeyEndsAQuarantine) {
  const int slot = ada.link().sessions().find_peer(bert.robot());
  TestRobot forger(session_settings(bert.name(), bert.link().sessions().own().boot), 66);
  for (int i = 0; i < 2000; ++i) (void)forger.say({});
  for (int i = 0; i < 3; ++i) hear(forger, forger.say({5, 200, 0, 1, 2, 3}));
  ASSERT_TRUE(ada.sync().quarantined(now(), slot));
  const FleetKeys both = {key_of(2), key_of(1), true};
  ada.link().sessions().set_keys(both);
  bert.link().sessions().set_keys(both);
  std::array<std::uint8_t, kMaxDatagramBytes> datagram;
  for (int i = 0; i < 2100; ++i) (void)bert.link().sessions().seal({}, datagram);
  fleet.network.run_for(8.0);
  expect_bert_is_heard();
}

// Ever new names with the key, each with a map, while bert goes on: they replace one another, and
// leave as many traces as there are places.
TEST_F(PeerExchangeOfTwo, EverNewNamesLeaveWhatThereIsRoomFor) {
  tell(fleet, 1, 40);
  fleet.network.run_for(8.0);
  std::array<std::uint8_t, kMaxDatagramBytes> room;
  for (std::uint64_t i = 0; i < 400; ++i) {
    TestRobot sybil("name-" + std::to_string(i), 9000 + i, 66);
    const Time now = fleet.network.now();
    ada.link().receive(now, sybil.address, sybil.hello(), ada);
    for (Dispatch d = ada.link().next(now, room); d.size > 0; d = ada.link().next(now, room)) {
      if (d.to_everybody || d.to != sybil.address) continue;
      sybil.hear(now, ada.address(),
                 Datagram(room.begin(), room.begin() + static_cast<std::ptrdiff_t>(d.size)));
    }
    for (const auto& [to, response] : sybil.answers()) {
      ada.link().receive(now, sybil.address, response, ada);
    }
    StateNotice state;
    state.map = static_cast<std::uint32_t>(i + 1);
    std::vector<std::uint8_t> payload(200);
    ByteWriter writer(payload);
    append(writer, state);
    payload.resize(writer.size());
    ada.link().receive(now, sybil.address, sybil.say(payload), ada);
    fleet.network.run_for(0.5);
  }
  int used = 0;
  int sybils = 0;
  for (int slot = 0; slot < kMaxReplicas; ++slot) {
    const PeerStatus& peer = ada.sync().peer(slot);
    used += peer.used ? 1 : 0;
    sybils += peer.used && peer.robot != bert.robot() ? 1 : 0;
  }
  EXPECT_GT(sybils, 20);
  EXPECT_LE(used, kMaxReplicas);
  EXPECT_TRUE(ada.complete(bert));
  EXPECT_EQ(ada.replica(bert)->size(), 40u);
  // The last one that came has a place, the first ones have none any more.
  EXPECT_GE(ada.slot_of(robot_id("name-399"), 400), 0);
  EXPECT_EQ(ada.slot_of(robot_id("name-0"), 1), -1);
}

}  // namespace
}  // namespace zenith::exchange
