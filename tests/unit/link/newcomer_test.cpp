// Somebody without the key plays what he recorded of many boots, again and again: each of them has
// a right tag and has to be challenged. A robot that is new gets to know the others all the same.

#include <memory>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/link_rig.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

class Newcomer : public testing::Test {
 protected:
  Newcomer() {
    for (std::uint64_t i = 0; i < 300; ++i) {
      TestRobot boot("r" + std::to_string(i % 5), 100 + i, 5);
      recorded_.push_back(boot.hello());
    }
  }

  // HELLOs that bert had to say until ada believed him. The recorded ones come `per_second` times,
  // from addresses that `address` gives; those from bert's own come between his.
  template <typename AddressOf>
  int hellos_needed(int per_second, AddressOf address) {
    TestRobot ada("ada", 1, 1);
    TestRobot bert("bert", 2, 2);
    std::size_t next = 0;
    double now_s = 0.0;
    const auto repeat = [&](int count) {
      for (int i = 0; i < count; ++i) {
        now_s += random_.uniform(0.5, 1.5) / per_second;
        ada.hear(at(now_s), address(next), recorded_[next % recorded_.size()]);
        ++next;
        ada.answers();
      }
    };
    repeat(10 * per_second);
    for (int hellos = 1; hellos <= 120; ++hellos) {
      verify(ada, bert, at(now_s + random_.uniform(0.0, 0.5) / per_second));
      if (ada.sessions.find_peer(bert.sessions.own().robot) >= 0) return hellos;
      repeat(per_second);
    }
    return 1000;
  }

  const TestSeed seed_;
  Random random_{seed_.value()};
  std::vector<Datagram> recorded_;
};

TEST_F(Newcomer, IsLetInWhileOneSourceRepeatsOldBoots) {
  const auto one = [](std::size_t) { return address_of(66); };
  EXPECT_LE(hellos_needed(49, one), 3);
  EXPECT_LE(hellos_needed(5000, one), 3);
}

TEST_F(Newcomer, IsLetInWhileASourceRepeatsThemFromManyPorts) {
  const auto ports = [](std::size_t i) {
    Endpoint from = address_of(66);
    from.port = static_cast<std::uint16_t>(1000 + i % 50000);
    return from;
  };
  EXPECT_LE(hellos_needed(500, ports), 3);
}

TEST_F(Newcomer, IsLetInWhileASourceRepeatsThemFromItsWholeIpv6Prefix) {
  const auto prefix = [](std::size_t i) {
    Endpoint from;
    from.is_ipv6 = true;
    from.address = {0x20, 0x01, 0x0D, 0xB8};
    from.address[14] = static_cast<std::uint8_t>(i >> 8u);
    from.address[15] = static_cast<std::uint8_t>(i);
    from.port = 7000;
    return from;
  };
  EXPECT_LE(hellos_needed(500, prefix), 3);
}

TEST_F(Newcomer, IsLetInWhileManySourcesRepeatThemSlowly) {
  const auto many = [](std::size_t i) {
    return address_of(static_cast<std::uint8_t>(20 + i % 200));
  };
  EXPECT_LE(hellos_needed(49, many), 3);
}

// What is left: who can send from many addresses makes newcomers wait, and no more than wait.
TEST_F(Newcomer, WaitsWhileManySourcesRepeatThemFast) {
  const auto many = [](std::size_t i) {
    return address_of(static_cast<std::uint8_t>(20 + i % 200));
  };
  EXPECT_LE(hellos_needed(500, many), 120);
}

// Its own HELLO, said again from elsewhere before it arrives.
TEST_F(Newcomer, IsChallengedWhereItIsAlthoughItsHelloCameFromElsewhere) {
  TestRobot ada("ada", 1, 1);
  TestRobot bert("bert", 2, 2);
  const Datagram hello = bert.hello();
  ada.hear(at(0), address_of(66), hello);
  ada.answers();
  ada.hear(at(0), bert.address, hello);
  const auto answers = ada.answers();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].first, bert.address);
}

// Recorded challenges for this boot use up the responses of one source alone.
TEST_F(Newcomer, RepeatedChallengesDoNotKeepARobotFromAnswering) {
  TestRobot bert("bert", 2, 2);
  std::vector<Datagram> challenges;
  for (std::uint64_t i = 0; i < 100; ++i) {
    TestRobot old("old" + std::to_string(i), 300 + i, 5);
    old.hear(at(0), bert.address, bert.hello());
    for (const auto& [to, challenge] : old.answers()) challenges.push_back(challenge);
  }
  ASSERT_EQ(challenges.size(), 100u);
  double now_s = 1.0;
  for (int i = 0; i < 5000; ++i) {
    now_s += 0.002;
    bert.hear(at(now_s), address_of(66), challenges[static_cast<std::size_t>(i) % 100]);
    bert.answers();
  }
  TestRobot ada("ada", 1, 1);
  verify(ada, bert, at(now_s));
  EXPECT_GE(ada.sessions.find_peer(bert.sessions.own().robot), 0);
}

}  // namespace
}  // namespace zenith
