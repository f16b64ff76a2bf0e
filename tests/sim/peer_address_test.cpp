// Where a peer is reached. Whoever repeats its datagrams from another address, before they arrive
// or after, gets no more bytes than it sent; a robot that really moves is served where it is.

#include <functional>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "tests/sim/exchange_fleet.h"
#include "tests/support/seeds.h"

namespace zenith::exchange {
namespace {

constexpr std::uint32_t kLandmarks = 1500;

class PeerAddress : public testing::Test {
 protected:
  using Carrier = std::function<void(Time, const Endpoint&, const Datagram&)>;

  // Bert is ada's peer and lacks most of her map, which she may send at any time.
  void SetUp() override {
    fleet_.network.run_for(6.0);
    now_ = fleet_.network.now();
    ASSERT_GE(ada_.link().sessions().find_peer(bert_.robot()), 0);
    ASSERT_GE(bert_.link().sessions().find_peer(ada_.robot()), 0);
    for (std::uint32_t id = 1; id <= kLandmarks; ++id) {
      ada_.set(made_up_record(fleet_.random, id));
    }
    run(4.0, [](Time, const Endpoint&, const Datagram&) {});
  }
  // All that ada sends to somebody until then, in steps of 5 ms.
  void run(double seconds, const Carrier& carry) {
    const Time end = now_ + Duration::from_seconds(seconds);
    for (; now_ < end; now_ = now_ + Duration{5'000'000}) flush(carry);
  }
  void flush(const Carrier& carry) {
    std::array<std::uint8_t, kMaxDatagramBytes> room;
    for (Dispatch d = ada_.link().next(now_, room); d.size > 0; d = ada_.link().next(now_, room)) {
      const Datagram datagram(room.begin(), room.begin() + static_cast<std::ptrdiff_t>(d.size));
      if (!d.to_everybody) sent_[d.to.address[3]] += d.size;
      carry(now_, d.to_everybody ? kToEverybody : d.to, datagram);
      for (const auto& [to, bytes] : sent_) {
        if (homes_.count(to) > 0) continue;
        ASSERT_LE(bytes, received_[to]) << "to address " << int{to};
      }
    }
  }
  // Bert's own words: all of ada's map, please.
  Datagram request() {
    std::vector<std::uint8_t> payload(kMaxPayload);
    ByteWriter writer(payload);
    Request request;
    request.robot = ada_.robot();
    request.map = ada_.map();
    request.ranges.push_back({1, kToHead});
    append(writer, request);
    return seal({payload.begin(), payload.begin() + static_cast<std::ptrdiff_t>(writer.size())});
  }
  Datagram seal(const std::vector<std::uint8_t>& payload) {
    Datagram datagram(kMaxDatagramBytes);
    datagram.resize(bert_.link().sessions().seal(payload, datagram));
    return datagram;
  }
  void hear(std::uint8_t from, const Datagram& datagram) {
    received_[from] += datagram.size();
    ada_.link().receive(now_, address_of(from), datagram, ada_);
  }
  int live(std::uint8_t home, double seconds) { return live(home, home, seconds); }
  // Bert runs at `home`: what he says to all comes from there, what he says to ada from `second`;
  // what is sent to one of them reaches him. Returns how many datagrams he had sent when the first
  // records came; 1000: none came.
  int live(std::uint8_t home, std::uint8_t second, double seconds) {
    homes_.insert({home, second});
    int said = 0;
    int said_until_served = 1000;
    const Time end = now_ + Duration::from_seconds(seconds);
    std::array<std::uint8_t, kMaxDatagramBytes> room;
    for (; now_ < end; now_ = now_ + Duration{5'000'000}) {
      auto& link = bert_.link();
      for (Dispatch d = link.next(now_, room); d.size > 0; d = link.next(now_, room)) {
        ++said;
        hear(d.to_everybody ? home : second,
             Datagram(room.begin(), room.begin() + static_cast<std::ptrdiff_t>(d.size)));
      }
      flush([&](Time, const Endpoint& to, const Datagram& datagram) {
        const bool is_here = to == address_of(home) || to == address_of(second);
        if (!is_here && to != kToEverybody) return;
        const bool is_served = is_here && datagram.size() > kAnswerBytes;
        if (is_served) said_until_served = std::min(said_until_served, said);
        link.receive(now_, address_of(1), datagram, bert_);
      });
    }
    return said_until_served;
  }

  static constexpr std::uint8_t kBert = 2;
  static constexpr std::uint8_t kVictim = 66;
  const Endpoint kToEverybody = address_of(255);
  std::set<std::uint8_t> homes_ = {kBert};  // where bert answered
  const TestSeed seed_;
  Fleet fleet_{2, seed_.value()};
  FleetNode& ada_ = fleet_.node(0);
  FleetNode& bert_ = fleet_.node(1);
  Time now_;
  std::map<std::uint8_t, std::size_t> sent_;      // by the last byte of the address
  std::map<std::uint8_t, std::size_t> received_;  // likewise
};

// The REQUEST is fresh: the attacker is faster than its sender.
TEST_F(PeerAddress, ARequestFromElsewhereIsNotAnsweredThere) {
  const Datagram request = this->request();
  hear(kVictim, request);
  hear(kBert, request);
  run(10.0, [](Time, const Endpoint&, const Datagram&) {});
  EXPECT_LE(sent_[kVictim], received_[kVictim]);
  EXPECT_GT(sent_[kBert], 100'000u) << "he is served where he is";
}

// Many of them, while the robot itself is not heard at all, and the same ones again.
TEST_F(PeerAddress, ManyRequestsFromElsewhereAreNoAmplifier) {
  for (int i = 0; i < 300; ++i) {
    const Datagram request = this->request();
    const auto from = static_cast<std::uint8_t>(i % 3 == 0 ? kVictim : 100 + i % 50);
    for (int k = 0; k < 3; ++k) hear(from, request);
    run(0.2, [](Time, const Endpoint&, const Datagram&) {});
  }
  EXPECT_LE(sent_[kVictim], received_[kVictim]);
  EXPECT_GT(sent_[kBert], 100'000u);
  EXPECT_GT(received_[kVictim], 10'000u);
}

// Likewise everything that a peer may say, also what asks for an answer at once.
TEST_F(PeerAddress, NothingThatIsRepeatedFromElsewhereIsAnAmplifier) {
  std::vector<std::uint8_t> challenge = {2, 32, 0};
  ByteWriter writer(challenge);
  challenge.resize(35);
  ByteWriter body{std::span(challenge).subspan(3)};
  body.u64(ada_.robot());
  body.u64(ada_.link().sessions().own().boot);
  for (int i = 0; i < 200; ++i) {
    hear(kVictim, seal(challenge));
    hear(kVictim, seal({99, 0, 0}));
    run(0.05, [](Time, const Endpoint&, const Datagram&) {});
  }
  EXPECT_GT(sent_[kVictim], 0u);
  EXPECT_LE(sent_[kVictim], received_[kVictim]);
}

TEST_F(PeerAddress, ARobotThatMovesIsServedAfterAFewDatagrams) {
  constexpr std::uint8_t kNew = 77;
  EXPECT_LE(live(kNew, 20.0), 8);
  EXPECT_EQ(ada_.link().sessions().session(0)->address, address_of(kNew));
  EXPECT_EQ(sent_[kBert], 0u);
  ASSERT_NE(bert_.replica(ada_), nullptr);
  EXPECT_EQ(bert_.replica(ada_)->size(), kLandmarks);
}

TEST_F(PeerAddress, ARobotThatMovesToAndFroIsServed) {
  for (std::uint8_t home = 77; home < 82; ++home) {
    ada_.set(made_up_record(fleet_.random, 5000u + home));
    (void)live(home, 12.0);
    EXPECT_EQ(ada_.link().sessions().session(0)->address, address_of(home));
    EXPECT_EQ(bert_.replica(ada_)->size(), ada_.own().size());
  }
}

// Two network cards on one network: what it says comes now from this, now from that one. It is
// reached at one of them, and seldom challenged.
TEST_F(PeerAddress, ARobotWithTwoAddressesIsReachedAtOneOfThem) {
  const std::uint64_t challenges = ada_.link().sessions().counters().challenges;
  for (int second = 0; second < 60; ++second) {
    (void)live(second % 2 == 0 ? kBert : kBert + 1, 1.0);
  }
  EXPECT_LE(ada_.link().sessions().counters().challenges - challenges, 30u);
  EXPECT_EQ(bert_.replica(ada_)->size(), kLandmarks);
}

// What it says to all leaves by one card, what it says to ada alone by the other.
TEST_F(PeerAddress, ARobotThatAnswersFromAnotherAddressIsReached) {
  const std::uint64_t challenges = ada_.link().sessions().counters().challenges;
  EXPECT_LE(live(77, 78, 60.0), 10);
  EXPECT_LE(ada_.link().sessions().counters().challenges - challenges, 10u);
  EXPECT_EQ(ada_.link().sessions().session(0)->address, address_of(77)) << "where it says most";
  EXPECT_EQ(bert_.replica(ada_)->size(), kLandmarks);
}

// It is let in by a RESPONSE that comes from another address than the one that was challenged:
// until it answers there, nothing larger goes there.
TEST(PeerAddressAtJoin, AResponseFromElsewhereIsNoProofOfThatAddress) {
  TestRobot ada("ada", 1, 1);
  TestRobot bert("bert", 2, 2);
  ada.hear(at(0), bert.address, bert.hello());
  bert.hear(at(0), ada.address, ada.answers().at(0).second);
  const Datagram response = bert.answers().at(0).second;
  ada.hear(at(0), address_of(66), response);
  const int slot = ada.sessions.find_peer(bert.sessions.own().robot);
  ASSERT_GE(slot, 0) << "it is bert's, wherever it came from";
  EXPECT_FALSE(ada.sessions.session(slot)->reached);
  const auto challenges = ada.answers();
  ASSERT_EQ(challenges.size(), 1u);
  EXPECT_EQ(challenges[0].first, address_of(66));
  EXPECT_LE(challenges[0].second.size(), response.size());
  // The answer to it shows that he is there.
  bert.hear(at(0.1), ada.address, challenges[0].second);
  ada.hear(at(0.2), address_of(66), bert.answers().at(0).second);
  EXPECT_TRUE(ada.sessions.session(slot)->reached);
  EXPECT_EQ(ada.sessions.session(slot)->address, address_of(66));
}

// What answers a challenge to come nearer lets nobody in who is not known any more.
TEST(PeerAddressAtJoin, AnAnswerFromANewAddressIsNoWayIn) {
  TestRobot ada("ada", 1, 1);
  TestRobot bert("bert", 2, 2);
  verify(ada, bert, at(0));
  ada.hear(at(3), address_of(77), bert.hello());
  bert.hear(at(3), ada.address, ada.answers().at(0).second);
  const Datagram answer = bert.answers().at(0).second;
  SessionSettings settings = session_settings("ada", 1);
  TestRobot again(settings, 1);  // the same secret, and bert is not known
  again.hear(at(3.5), address_of(77), answer);
  EXPECT_EQ(again.sessions.find_peer(bert.sessions.own().robot), -1);
}

}  // namespace
}  // namespace zenith::exchange
