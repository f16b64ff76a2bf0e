// A robot that knows as many others as it can: whoever restarts gets back in, at once or after the
// ten seconds that its last RESPONSE could be repeated; newcomers get the places of the silent.

#include <algorithm>
#include <memory>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/link_rig.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

class FullFleet : public testing::Test {
 protected:
  void SetUp() override {
    for (std::size_t i = 0; i < kMaxSessions; ++i) start(i);
    for (int s = 0; s < 30; ++s) second();
    ASSERT_EQ(peers(), static_cast<std::size_t>(kMaxSessions));
    ada_.events();
  }

  // Robot number i starts, or starts again: nothing is left of its last boot.
  void start(std::size_t i) {
    if (fleet_.size() <= i) fleet_.resize(i + 1);
    const auto address = static_cast<std::uint8_t>(10 + i);
    fleet_[i] = std::make_unique<TestRobot>("r" + std::to_string(i), next_boot_++, address);
  }
  // Everybody who is there says HELLO; challenges and responses come and go.
  void second() {
    now_s_ += 1.0;
    for (std::size_t i = 0; i < fleet_.size(); ++i) {
      if (fleet_[i] == nullptr) continue;
      const Datagram hello = fleet_[i]->hello();
      if (recorded_.size() < 5000) recorded_.push_back(hello);
      ada_.hear(at(now_s_), fleet_[i]->address, hello);
      exchange_answers();
    }
  }
  void exchange_answers() {
    for (const auto& [to, challenge] : ada_.answers()) {
      for (const auto& robot : fleet_) {
        if (robot != nullptr && robot->address == to) {
          robot->hear(at(now_s_), ada_.address, challenge);
          for (const auto& [back, response] : robot->answers()) {
            recorded_.push_back(response);
            ada_.hear(at(now_s_), robot->address, response);
          }
        }
      }
    }
  }
  bool is_peer(std::size_t i) const {
    const SenderId id = fleet_[i]->sessions.own();
    const int slot = ada_.sessions.find_peer(id.robot);
    return slot >= 0 && ada_.sessions.session(slot)->id == id;
  }
  std::size_t peers() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < fleet_.size(); ++i) count += fleet_[i] && is_peer(i) ? 1 : 0;
    return count;
  }
  // Everything that was ever said, from the robots' own addresses and from elsewhere.
  void repeat_all(Random& random) {
    for (const Datagram& datagram : recorded_) {
      const auto from = static_cast<std::uint8_t>(10 + random.below(kMaxSessions));
      ada_.hear(at(now_s_), address_of(random.below(2) == 0 ? from : 200), datagram);
    }
    exchange_answers();
  }
  // Seconds until all are peers that are there; 100: never.
  double seconds_until_all_are_in() {
    const double begin_s = now_s_;
    while (peers() < kMaxSessions && now_s_ - begin_s < 100.0) second();
    return now_s_ - begin_s;
  }

  const TestSeed seed_;
  TestRobot ada_{"ada", 1, 1};
  std::vector<std::unique_ptr<TestRobot>> fleet_;
  std::vector<Datagram> recorded_;
  std::uint64_t next_boot_ = 1000;
  double now_s_ = 0.0;
};

TEST_F(FullFleet, EachOneThatRestartsGetsBackIn) {
  Random random(seed_.value());
  std::vector<std::size_t> order(kMaxSessions);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = order.size() - 1; i > 0; --i) {
    std::swap(order[i], order[random.below(static_cast<std::uint32_t>(i + 1))]);
  }
  double longest_s = 0.0;
  for (const std::size_t i : order) {
    start(i);
    longest_s = std::max(longest_s, seconds_until_all_are_in());
    ASSERT_EQ(peers(), static_cast<std::size_t>(kMaxSessions)) << "r" << i;
    // And stays in: it is heard from then on, and so is everybody else.
    for (int s = 0; s < 3; ++s) second();
    ASSERT_EQ(peers(), static_cast<std::size_t>(kMaxSessions)) << "r" << i;
  }
  EXPECT_LE(longest_s, 3.0);
  for (const LinkEvent& event : ada_.events()) EXPECT_EQ(event.kind, LinkEventKind::kRestarted);
}

// Off for longer than it takes to be given up: its own place is the one that was silent longest.
TEST_F(FullFleet, OneThatWasAwayGetsBackIn) {
  const std::unique_ptr<TestRobot> away = std::move(fleet_[7]);
  for (int s = 0; s < 20; ++s) second();
  start(7);
  EXPECT_LE(seconds_until_all_are_in(), 3.0);
  for (int s = 0; s < 30; ++s) second();
  EXPECT_EQ(peers(), static_cast<std::size_t>(kMaxSessions)) << "superseded by itself";
}

TEST_F(FullFleet, SeveralAtOnceGetBackIn) {
  for (const std::size_t many : {2u, 10u, 40u, 63u}) {
    for (int s = 0; s < 11; ++s) second();
    for (std::size_t i = 0; i < many; ++i) start(i);
    EXPECT_LE(seconds_until_all_are_in(), 6.0) << many;
  }
}

TEST_F(FullFleet, OneThatRestartsAgainAndAgainGetsBackIn) {
  for (int i = 0; i < 10; ++i) {
    start(5);
    for (int s = 0; s < i % 4; ++s) second();
  }
  EXPECT_LE(seconds_until_all_are_in(), 12.0);
}

TEST_F(FullFleet, OldBootsThatAreRepeatedKeepNobodyOut) {
  Random random(seed_.value());
  for (const std::size_t i : {3u, 30u, 60u}) {
    start(i);
    double took_s = 0.0;
    while (!is_peer(i) && took_s < 100.0) {
      repeat_all(random);
      second();
      took_s += 1.0;
    }
    EXPECT_LT(took_s, 30.0) << "r" << i;
    for (int s = 0; s < 12; ++s) {
      repeat_all(random);
      second();
    }
    EXPECT_EQ(peers(), static_cast<std::size_t>(kMaxSessions));
    EXPECT_TRUE(is_peer(i)) << "displaced by its own older boot";
  }
}

TEST_F(FullFleet, ANewcomerGetsThePlaceOfOneThatIsSilent) {
  fleet_.resize(kMaxSessions + 1);
  start(kMaxSessions);
  for (int s = 0; s < 20; ++s) second();
  EXPECT_FALSE(is_peer(kMaxSessions)) << "63 that talk stay";
  EXPECT_GT(ada_.rejected(Rejected::kNoRoom), 1u);
  const auto told = ada_.events();
  EXPECT_EQ(std::count_if(told.begin(), told.end(),
                          [](const LinkEvent& e) { return e.kind == LinkEventKind::kNoRoom; }),
            1)
      << "once, however often it asks";
  const std::uint64_t silent = fleet_[4]->sessions.own().robot;
  fleet_[4].reset();
  for (int s = 0; s < 8; ++s) second();
  EXPECT_TRUE(is_peer(kMaxSessions));
  EXPECT_EQ(ada_.sessions.find_peer(silent), -1);
  EXPECT_EQ(peers(), static_cast<std::size_t>(kMaxSessions)) << "and nobody else went";
}

// With the key: ever new names. They take what is free, and what is silent; nobody who talks.
TEST_F(FullFleet, EverNewNamesReplaceOneAnother) {
  for (std::size_t i = 20; i < kMaxSessions; ++i) fleet_[i].reset();
  for (int s = 0; s < 6; ++s) second();
  std::size_t let_in = 0;
  for (std::uint64_t i = 0; i < 600; ++i) {
    TestRobot sybil("sybil" + std::to_string(i), 5000 + i, 250);
    now_s_ += 0.1;
    verify(ada_, sybil, at(now_s_));
    let_in += ada_.sessions.find_peer(sybil.sessions.own().robot) >= 0 ? 1 : 0;
    if (i % 10 == 9) second();
  }
  EXPECT_GT(let_in, 100u);
  EXPECT_EQ(peers(), 20u) << "those who talk are not displaced";
  // They come to an end: five seconds after the last of them all places are free for others.
  for (int s = 0; s < 12; ++s) second();
  for (std::size_t i = 20; i < kMaxSessions; ++i) start(i);
  EXPECT_LE(seconds_until_all_are_in(), 10.0);
}

}  // namespace
}  // namespace zenith
