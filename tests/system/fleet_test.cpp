// Real daemons with simulated robots on a network of their own: they build one map, survive pulled
// cables, restarts, and somebody who means them ill.

#include <gtest/gtest.h>

#include <memory>

#include "platform/link/sealing.h"
#include "tests/support/seeds.h"
#include "tests/system/fleet_rig.h"
#include "tests/system/hostile.h"

namespace zenith {
namespace {

class FleetTest : public FleetRig {
 protected:
  void attack(const Daemons& all, SimDaemon& victim);
};

TEST_F(FleetTest, TwoRobotsBuildOneMapWhateverHappens) {
  SimDaemon r1 = robot(1);
  SimDaemon r2 = robot(2);
  const Daemons all = {&r1, &r2};
  const Time started = monotonic_now();
  for (SimDaemon* daemon : all) ASSERT_TRUE(daemon->start()) << daemon->log();
  ASSERT_TRUE(listen_until(all, kLimit_s, [&] { return r1.merged("r2") && r2.merged("r1"); }))
      << r1.log() << r2.log();
  print_figure("two daemons over UDP: merged %.0f s after their start",
               (monotonic_now() - started).seconds());
  expect_true(r1, r2, 1, 2);
  expect_true(r2, r1, 2, 1);
  EXPECT_EQ(r1.peer("r2")["address"], NetWorld::address(2) + ":21474");

  attack(all, r1);

  // The cable is pulled: both go on alone, and are in step again when it is back.
  ASSERT_TRUE(world_.pull_cable(2));
  ASSERT_TRUE(listen_until(all, kLimit_s, [&] {
    const auto peer = r1.peer("r2");
    return !peer.is_null() && peer["age_s"].get<double>() > 4.0;
  }));
  EXPECT_TRUE(r1.merged("r2"));
  ASSERT_TRUE(world_.plug_cable(2));
  EXPECT_TRUE(listen_until(all, kLimit_s, [&] {
    const auto peer = r1.peer("r2");
    return complete(r1, r2) && complete(r2, r1) && peer["age_s"].get<double>() < 3.0;
  })) << r1.latest("radio");

  // One dies and begins anew: another map of the same robot; the old merge stays.
  const int before = r1.peer("r2")["peer"].get<int>();
  r2.kill();
  ASSERT_TRUE(r2.start()) << r2.log();
  EXPECT_TRUE(listen_until(all, kLimit_s, [&] {
    const auto peer = r1.peer("r2");
    return !peer.is_null() && peer["peer"].get<int>() != before && complete(r1, r2);
  })) << r1.log();
  EXPECT_TRUE(r1.logged("robot r2 began anew"));
  EXPECT_TRUE(r1.merged("r2"));

  // And goodbye.
  EXPECT_EQ(r2.stop(), 0);
  EXPECT_TRUE(listen_until({&r1}, kLimit_s, [&] { return r1.logged("robot r2 said goodbye"); }))
      << r1.log();
  EXPECT_EQ(r1.stop(), 0);
}

// Everything that somebody can send, with and without the key.
void FleetTest::attack(const Daemons& all, SimDaemon& victim) {
  const TestSeed seed;
  const auto keys = read_fleet_keys(key_file());
  ASSERT_TRUE(keys.ok());
  const auto sum = [&] {
    std::uint64_t all_reasons = 0;
    const nlohmann::json radio = victim.latest("radio");
    for (const auto& count : radio["rejected"]) all_reasons += count.get<std::uint64_t>();
    return all_reasons;
  };
  const auto before = victim.latest("radio");
  const std::uint64_t rejected = sum();
  const auto alignment = victim.merged("r2");

  std::unique_ptr<Hostile> hostile;
  UniqueFd sockets;
  ASSERT_TRUE(world_.on(
      1, [&] { sockets = UniqueFd(::open("/proc/thread-self/net/udp", O_RDONLY | O_CLOEXEC)); }));
  ASSERT_TRUE(sockets.is_open());
  ASSERT_TRUE(world_.on(3, [&] {
    hostile = std::make_unique<Hostile>(NetWorld::address(1) + ":21474", std::move(sockets),
                                        seed.value());
    if (!hostile->open()) hostile.reset();
  }));
  ASSERT_TRUE(hostile);
  const auto recorded = hostile->record({4'000'000'000}, 5);
  ASSERT_GT(recorded.size(), 4u) << "nothing to replay";
  std::uint64_t sent = 0;
  for (int round = 0; round < 20; ++round) {
    sent += hostile->replay(recorded);
    sent += hostile->flip_bits(recorded);
    sent += hostile->truncate(recorded);
    sent += hostile->spoof(recorded);
  }
  sent += hostile->flood(2000);
  sent += hostile->knock(*keys, 500);
  sent += hostile->speak_other_versions(*keys, 300);
  EXPECT_TRUE(listen_until(all, kLimit_s, [&] { return sum() >= rejected + sent; }))
      << "sent " << sent << ", rejected " << sum() - rejected << ": " << victim.latest("radio");
  print_figure("two daemons over UDP: of %llu hostile datagrams %llu were rejected",
               static_cast<unsigned long long>(sent),
               static_cast<unsigned long long>(std::min(sum() - rejected, sent)));

  const auto after = victim.latest("radio");
  EXPECT_EQ(after["udp"]["dropped"], before["udp"]["dropped"]);
  // Whatever came is accounted for: fresh from r2, rejected, or the one RESPONSE that verified it.
  EXPECT_EQ(after["udp"]["received"].get<std::uint64_t>(),
            after["link"]["received"].get<std::uint64_t>() + sum() +
                after["link"]["verified"].get<std::uint64_t>());
  EXPECT_EQ(after["peers"], 1);
  EXPECT_EQ(after["link"]["verified"], before["link"]["verified"]);
  EXPECT_EQ(after["exchange"]["faults"], 0);
  EXPECT_LE(after["link"]["challenges"].get<int>(), before["link"]["challenges"].get<int>() + 1000);
  EXPECT_EQ(victim.peer("r2")["address"], NetWorld::address(2) + ":21474");
  ASSERT_TRUE(victim.merged("r2"));
  EXPECT_NEAR(victim.merged("r2")->x_m, alignment->x_m, 0.3);
  EXPECT_TRUE(victim.logged("of the protocol, this one 2"));

  // Somebody inside, verified as a robot: quarantined, and nothing of it is used.
  ASSERT_TRUE(hostile->tell_extremes(*keys, robot_id("r1"), [&] {
    victim.listen();
    return !victim.peer("mallory").is_null();
  }));
  EXPECT_TRUE(listen_until(all, kLimit_s, [&] {
    const auto mallory = victim.peer("mallory");
    return !mallory.is_null() && mallory["quarantined"] == true;
  })) << victim.log();
  EXPECT_TRUE(victim.logged("robot mallory") && victim.logged("too many faults"));
  EXPECT_EQ(victim.peer("mallory")["landmarks"], 0);
  EXPECT_TRUE(victim.merged("r2"));
}

}  // namespace
}  // namespace zenith
