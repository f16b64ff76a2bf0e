// Whatever the network did: once it is well again, every robot has every other robot's map, record
// by record.

#include <gtest/gtest.h>

#include "tests/sim/exchange_fleet.h"
#include "tests/support/figure.h"
#include "tests/support/seeds.h"

namespace zenith::exchange {
namespace {

// Robots that map: every step some landmarks are new, some changed, few go.
class Mapping {
 public:
  explicit Mapping(Fleet& fleet)
      : fleet_(fleet), next_id_(static_cast<std::size_t>(fleet.size())) {}

  void step(int robot, int news, int changes) {
    Random& random = fleet_.random;
    FleetNode& node = fleet_.node(robot);
    std::uint32_t& next = next_id_[static_cast<std::size_t>(robot)];
    for (int i = 0; i < news; ++i) {
      node.set(made_up_record(random, ++next,
                              1 + static_cast<int>(random.below(kPublishedAppearances))));
    }
    for (int i = 0; i < changes && next > 0; ++i) {
      const std::uint32_t id = 1 + random.below(next);
      if (random.below(10) == 0) {
        node.remove(id);
      } else if (const auto known = node.own().find(id); known != node.own().end()) {
        LandmarkRecord r = known->second;
        r.x_m += static_cast<float>(random.uniform(-0.1, 0.1));
        r.observations = static_cast<std::uint16_t>(random.below(256));
        node.set(r);
      }
    }
  }
  // All robots, once a second.
  void run(double seconds, int news, int changes) {
    for (double t = 0.0; t < seconds; t += 1.0) {
      for (int robot = 0; robot < fleet_.size(); ++robot) step(robot, news, changes);
      fleet_.network.run_for(1.0);
    }
  }

 private:
  Fleet& fleet_;
  std::vector<std::uint32_t> next_id_;
};

void expect_complete(Fleet& fleet) {
  fleet.network.run_for(3.0);
  for (int reader = 0; reader < fleet.size(); ++reader) {
    for (int owner = 0; owner < fleet.size(); ++owner) {
      if (reader == owner) continue;
      EXPECT_TRUE(fleet.node(reader).complete(fleet.node(owner)))
          << reader << " does not know that it has all of " << owner;
    }
    EXPECT_EQ(fleet.node(reader).sync().counters().inconsistent, 0u);
    EXPECT_EQ(fleet.node(reader).sync().counters().malformed, 0u);
    EXPECT_EQ(fleet.node(reader).sync().counters().too_much, 0u);
    EXPECT_EQ(fleet.node(reader).sync().counters().checksum_differed, 0u);
    EXPECT_EQ(fleet.node(reader).rejected(Rejected::kMalformed), 0u);
    EXPECT_EQ(fleet.node(reader).rejected(Rejected::kNoRoom), 0u);
    EXPECT_LE(fleet.network.traffic(reader).busiest_second_bytes, Settings{}.max_rate);
  }
}

TEST(ExchangeConvergence, ThroughLossReorderingAndDuplication) {
  const TestSeed seed;
  Fleet fleet(4, seed.value());
  sim::NetworkLink bad;
  bad.loss = 0.3;
  bad.duplication = 0.2;
  bad.jitter_s = 0.2;
  fleet.network.set_all(bad);
  Mapping mapping(fleet);
  mapping.run(60.0, 6, 10);
  fleet.network.set_all({});
  EXPECT_LT(fleet.run_until_same(30.0), 30.0) << fleet.first_difference();
  expect_complete(fleet);
}

TEST(ExchangeConvergence, WhileALossyNetworkStaysLossy) {
  const TestSeed seed;
  Fleet fleet(3, seed.value());
  sim::NetworkLink bad;
  bad.loss = 0.3;
  fleet.network.set_all(bad);
  Mapping mapping(fleet);
  mapping.run(30.0, 6, 10);
  const double took_s = fleet.run_until_same(60.0);
  EXPECT_LT(took_s, 60.0) << fleet.first_difference();
  print_figure("exchange: 3 robots, 30 %% loss that stays: in step %.1f s after the last change",
               took_s);
}

TEST(ExchangeConvergence, AfterTenMinutesApart) {
  const TestSeed seed;
  Fleet fleet(4, seed.value());
  Mapping mapping(fleet);
  mapping.run(20.0, 5, 5);
  fleet.network.partition({{0, 1}, {2, 3}});
  mapping.run(600.0, 1, 4);
  EXPECT_NE(fleet.first_difference(), "");
  fleet.network.heal();
  const double took_s = fleet.run_until_same(60.0);
  EXPECT_LT(took_s, 60.0) << fleet.first_difference();
  print_figure("exchange: in step %.1f s after 10 minutes apart, %zu landmarks each", took_s,
               fleet.node(0).own().size());
  expect_complete(fleet);
}

TEST(ExchangeConvergence, AfterAMinuteOfAlmostNothing) {
  const TestSeed seed;
  Fleet fleet(3, seed.value());
  Mapping mapping(fleet);
  mapping.run(10.0, 5, 5);
  sim::NetworkLink bad;
  bad.loss = 0.9;
  fleet.network.set_all(bad);
  mapping.run(60.0, 5, 10);
  fleet.network.set_all({});
  EXPECT_LT(fleet.run_until_same(30.0), 30.0) << fleet.first_difference();
  expect_complete(fleet);
}

TEST(ExchangeConvergence, WhoComesLateGetsAll) {
  const TestSeed seed;
  Fleet fleet(3, seed.value());
  fleet.node(2).switch_on(false);
  Mapping mapping(fleet);
  for (int t = 0; t < 60; ++t) {
    mapping.step(0, 5, 5);
    mapping.step(1, 5, 5);
    fleet.network.run_for(1.0);
  }
  fleet.node(2).switch_on(true);
  EXPECT_LT(fleet.run_until_same(20.0), 20.0) << fleet.first_difference();
  expect_complete(fleet);
}

TEST(ExchangeConvergence, ARestartIsAnotherMapAndTheOldOneStays) {
  const TestSeed seed;
  Fleet fleet(3, seed.value());
  Mapping mapping(fleet);
  mapping.run(30.0, 5, 5);
  fleet.run_until_same(20.0);
  const RecordMap before = fleet.node(1).own();
  const std::uint32_t old_map = fleet.node(1).map();
  fleet.node(1).restart(777);
  for (int t = 0; t < 20; ++t) {
    mapping.step(1, 5, 3);
    fleet.network.run_for(1.0);
  }
  EXPECT_LT(fleet.run_until_same(20.0), 20.0) << fleet.first_difference();
  expect_complete(fleet);
  for (const int reader : {0, 2}) {
    const RecordMap* old = fleet.node(reader).replica(fleet.node(1).robot(), old_map);
    ASSERT_NE(old, nullptr);
    std::size_t present = 0;
    for (const auto& [id, record] : *old) present += record.removed ? 0 : 1;
    EXPECT_EQ(present, before.size());
  }
}

TEST(ExchangeConvergence, AMapThatBeginsAnewIsAnotherMap) {
  const TestSeed seed;
  Fleet fleet(3, seed.value());
  sim::NetworkLink bad;
  bad.loss = 0.2;
  bad.jitter_s = 0.1;
  fleet.network.set_all(bad);
  Mapping mapping(fleet);
  mapping.run(30.0, 5, 5);
  const std::uint32_t old_map = fleet.node(0).map();
  fleet.node(0).begin_anew(4242);
  mapping.run(15.0, 5, 5);
  fleet.network.set_all({});
  EXPECT_LT(fleet.run_until_same(20.0), 20.0) << fleet.first_difference();
  expect_complete(fleet);
  EXPECT_NE(fleet.node(1).replica(fleet.node(0).robot(), old_map), nullptr)
      << "the old map is gone";
}

// 0 does not hear 1 any more, but 1 hears 0; 2 hears and is heard by both. Nobody passes on what
// others said, so 0 cannot follow 1's map, but nothing else may suffer.
TEST(ExchangeConvergence, ALinkThatFailsOneWayHarmsNobodyElse) {
  const TestSeed seed;
  Fleet fleet(3, seed.value());
  Mapping mapping(fleet);
  mapping.run(10.0, 5, 5);
  fleet.network.link(1, 0).up = false;
  mapping.run(60.0, 5, 5);
  fleet.network.run_for(10.0);
  EXPECT_TRUE(fleet.node(1).complete(fleet.node(0)));
  EXPECT_TRUE(fleet.node(2).complete(fleet.node(0)));
  EXPECT_TRUE(fleet.node(2).complete(fleet.node(1)));
  EXPECT_TRUE(fleet.node(0).complete(fleet.node(2)));
  EXPECT_NE(fleet.first_difference(), "");
  fleet.network.heal();
  EXPECT_LT(fleet.run_until_same(20.0), 20.0) << fleet.first_difference();
  expect_complete(fleet);
}

TEST(ExchangeConvergence, DamagedDatagramsAreNoticed) {
  const TestSeed seed;
  Fleet fleet(3, seed.value());
  sim::NetworkLink bad;
  bad.corruption = 0.2;
  fleet.network.set_all(bad);
  Mapping mapping(fleet);
  mapping.run(30.0, 5, 5);
  EXPECT_LT(fleet.run_until_same(30.0), 30.0) << fleet.first_difference();
  expect_complete(fleet);
  std::uint64_t noticed = 0;
  for (int i = 0; i < 3; ++i) {
    // A damaged key hint, tag or counter; before that, a datagram of nobody.
    for (const Rejected reason :
         {Rejected::kForeign, Rejected::kOtherKey, Rejected::kForged, Rejected::kRepeated}) {
      noticed += fleet.node(i).rejected(reason);
    }
  }
  EXPECT_GT(fleet.network.corrupted(), 20u);
  EXPECT_EQ(noticed, fleet.network.corrupted());
}

}  // namespace
}  // namespace zenith::exchange
