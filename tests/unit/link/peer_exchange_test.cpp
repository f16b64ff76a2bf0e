#include "platform/link/peer_exchange.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/link/link_rig.h"

namespace zenith {
namespace {

// What a robot has of its peers' maps.
class Maps final : public exchange::RecordSink {
 public:
  std::size_t room(int) override { return 1000; }
  void take(int slot, const LandmarkRecord& record) override { of[slot][record.id] = record; }
  void forget(int slot) override {
    of.erase(slot);
    ++forgotten;
  }

  std::map<int, std::map<std::uint32_t, LandmarkRecord>> of;
  int forgotten = 0;
};

PeerExchangeSettings exchange_settings(const std::string& name, std::uint64_t boot) {
  PeerExchangeSettings settings;
  settings.sessions = session_settings(name, boot);
  settings.synchroniser.map = static_cast<std::uint32_t>(1000 + boot);
  settings.synchroniser.seed = boot;
  return settings;
}

struct Node {
  Node(const std::string& name, std::uint64_t boot, std::uint8_t number)
      : exchange(std::make_unique<PeerExchange>(exchange_settings(name, boot))),
        address(address_of(number)) {}

  std::unique_ptr<PeerExchange> exchange;
  Endpoint address;
  Maps maps;
  std::uint64_t sent = 0;

  std::uint64_t rejected(Rejected reason) const {
    return exchange->sessions().counters().rejected[static_cast<std::size_t>(reason)];
  }
};

// Everybody hears everybody, at once.
class Air {
 public:
  void add(Node& node) { nodes_.push_back(&node); }
  void remove(Node& node) { std::erase(nodes_, &node); }

  void run(double seconds) {
    constexpr Duration kStep = {20'000'000};
    for (const Time end = now + Duration::from_seconds(seconds); now < end; now = now + kStep) {
      for (Node* node : nodes_) send(*node);
      for (Node* node : nodes_) node->exchange->forget_silent(now);
    }
  }
  void send(Node& from) {
    std::array<std::uint8_t, kMaxDatagramBytes> datagram;
    for (int i = 0; i < 100; ++i) {
      const Dispatch dispatch = from.exchange->next(now, datagram);
      if (dispatch.size == 0) return;
      ++from.sent;
      const auto bytes = std::span<const std::uint8_t>(datagram).first(dispatch.size);
      recorded.emplace_back(bytes.begin(), bytes.end());
      for (Node* to : nodes_) {
        if (to == &from && !dispatch.to_everybody) continue;
        if (dispatch.to_everybody || to->address == dispatch.to) {
          to->exchange->receive(now, from.address, bytes, to->maps);
        }
      }
    }
  }

  Time now = at(0);
  std::vector<Datagram> recorded;

 private:
  std::vector<Node*> nodes_;
};

LandmarkRecord landmark(std::uint32_t id) {
  LandmarkRecord record;
  record.id = id;
  record.x_m = 0.25F * static_cast<float>(id);
  record.y_m = -1.5F;
  record.z_m = 2.5F;
  record.covariance_m2 = {0.01F, 0.0F, 0.0F, 0.01F, 0.0F, 0.01F};
  record.observations = 7;
  record.appearance_count = 1;
  record.appearances[0].descriptor[3] = 126;
  return record;
}

void tell(Node& node, std::uint32_t first, std::uint32_t last) {
  for (std::uint32_t id = first; id <= last; ++id) {
    ASSERT_TRUE(node.exchange->synchroniser().set_own(landmark(id)));
  }
}

// The slot in which `node` keeps the map of `peer`, or -1.
int slot_of(const Node& node, const Node& peer) {
  const int session = node.exchange->sessions().find_peer(peer.exchange->sessions().own().robot);
  return session < 0 ? -1 : node.exchange->synchroniser().slot_of(session);
}

TEST(PeerExchange, ThreeRobotsGetEachOthersMaps) {
  Node ada("ada", 1, 1);
  Node bert("bert", 2, 2);
  Node carl("carl", 3, 3);
  Air air;
  for (Node* node : {&ada, &bert, &carl}) {
    tell(*node, 1, 200);
    air.add(*node);
  }
  air.run(15.0);
  for (Node* node : {&ada, &bert, &carl}) {
    for (Node* peer : {&ada, &bert, &carl}) {
      if (node == peer) continue;
      const int slot = slot_of(*node, *peer);
      ASSERT_GE(slot, 0);
      EXPECT_EQ(node->maps.of[slot].size(), 200u);
      EXPECT_TRUE(node->exchange->synchroniser().peer(slot).complete);
    }
    EXPECT_EQ(node->rejected(Rejected::kForged), 0u);
    EXPECT_EQ(node->rejected(Rejected::kMalformed), 0u);
    EXPECT_EQ(node->rejected(Rejected::kEcho), 0u + node->rejected(Rejected::kEcho));
  }
  const int slot = slot_of(ada, bert);
  EXPECT_NEAR(ada.maps.of[slot][40].x_m, 10.0F, 0.001F);
}

TEST(PeerExchange, APeerThatBeginsAnewIsAnotherMap) {
  Node ada("ada", 1, 1);
  auto bert = std::make_unique<Node>("bert", 2, 2);
  Air air;
  air.add(ada);
  air.add(*bert);
  tell(*bert, 1, 50);
  air.run(8.0);
  const int before = slot_of(ada, *bert);
  ASSERT_GE(before, 0);
  EXPECT_EQ(ada.maps.of[before].size(), 50u);

  air.remove(*bert);
  Node again("bert", 9, 2);
  tell(again, 1, 20);
  air.add(again);
  air.run(8.0);
  const int after = slot_of(ada, again);
  ASSERT_GE(after, 0);
  EXPECT_NE(after, before);
  EXPECT_EQ(ada.maps.of[after].size(), 20u);
  EXPECT_EQ(ada.maps.of[before].size(), 50u) << "as long as there is room it stays";
}

TEST(PeerExchange, ByeEndsTheSessionAndTheMapStays) {
  Node ada("ada", 1, 1);
  Node bert("bert", 2, 2);
  Air air;
  air.add(ada);
  air.add(bert);
  tell(bert, 1, 30);
  air.run(8.0);
  const int slot = slot_of(ada, bert);
  ASSERT_GE(slot, 0);
  bert.exchange->synchroniser().say_bye();
  air.send(bert);
  EXPECT_EQ(slot_of(ada, bert), -1);
  EXPECT_EQ(ada.exchange->synchroniser().peer(slot).session, -1);
  EXPECT_EQ(ada.maps.of[slot].size(), 30u);
}

// All that was ever said, said again, from elsewhere: nothing changes.
TEST(PeerExchange, ReplayedTrafficChangesNothing) {
  Node ada("ada", 1, 1);
  Node bert("bert", 2, 2);
  Air air;
  air.add(ada);
  air.add(bert);
  tell(bert, 1, 60);
  air.run(8.0);
  const int slot = slot_of(ada, bert);
  ASSERT_GE(slot, 0);
  const auto maps = ada.maps.of;
  const auto before = ada.exchange->sessions().counters();
  for (const Datagram& datagram : air.recorded) {
    ada.exchange->receive(air.now, address_of(66), datagram, ada.maps);
  }
  const auto& after = ada.exchange->sessions().counters();
  EXPECT_EQ(after.received, before.received);
  std::uint64_t rejected = 0;
  for (std::size_t i = 0; i < kRejectedKinds; ++i) {
    rejected += after.rejected[i] - before.rejected[i];
  }
  EXPECT_EQ(rejected, air.recorded.size());
  EXPECT_EQ(ada.maps.of.at(slot).size(), maps.at(slot).size());
  const int session = ada.exchange->sessions().find_peer(bert.exchange->sessions().own().robot);
  EXPECT_EQ(ada.exchange->sessions().session(session)->address, bert.address);
}

TEST(PeerExchange, ARobotThatKeepsMakingFaultsIsQuarantined) {
  Node ada("ada", 1, 1);
  Node bert("bert", 2, 2);
  Air air;
  air.add(ada);
  air.add(bert);
  tell(bert, 1, 30);
  air.run(8.0);
  ASSERT_GE(slot_of(ada, bert), 0);
  std::array<std::uint8_t, kMaxDatagramBytes> datagram;
  for (int i = 0; i < 4; ++i) {
    const std::vector<std::uint8_t> cut = {5, 200, 0, 1, 2, 3};
    const std::size_t size = bert.exchange->sessions().seal(cut, datagram);
    ada.exchange->receive(air.now, bert.address, std::span(datagram).first(size), ada.maps);
  }
  EXPECT_EQ(ada.rejected(Rejected::kMalformed), 3u);
  EXPECT_EQ(ada.rejected(Rejected::kQuarantined), 1u);
  bool told = false;
  for (LinkEvent event; ada.exchange->sessions().next_event(event);) {
    told = told || event.kind == LinkEventKind::kQuarantined;
  }
  EXPECT_TRUE(told);
}

}  // namespace
}  // namespace zenith
