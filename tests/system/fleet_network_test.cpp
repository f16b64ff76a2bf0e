// Three real daemons: what they send on the wire, a cable that is pulled, keys that change while
// they run, and a network that loses a third of everything.

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <vector>

#include "tests/system/fleet_rig.h"
#include "tests/system/lossy_wire.h"
#include "tests/system/wire_tap.h"

namespace zenith {
namespace {

class FleetNetworkTest : public FleetRig {
 protected:
  static constexpr double kCap_Bps = 125'000.0;  // radio.max_rate

  bool all_of(bool (*holds)(const SimDaemon&, const SimDaemon&), const Daemons& fleet) const {
    for (const SimDaemon* own : fleet) {
      for (const SimDaemon* peer : fleet) {
        if (own != peer && !holds(*own, *peer)) return false;
      }
    }
    return true;
  }
  bool all_merged() const {
    return all_of([](const SimDaemon& a, const SimDaemon& b) { return !!a.merged(b.name()); },
                  all_);
  }
  bool all_complete() const { return all_of(&FleetRig::complete, all_); }
  bool start_all() {
    for (SimDaemon* daemon : all_) {
      if (!daemon->start()) return false;
    }
    return true;
  }
  static double age_s(const SimDaemon& own, const SimDaemon& peer) {
    const auto line = own.peer(peer.name());
    return line.is_null() ? 1e9 : line["age_s"].get<double>();
  }
  // Seconds until `holds`; a failure when it does not.
  template <typename Holds>
  double wait_for(const char* what, Holds holds) {
    const Time start = monotonic_now();
    if (!listen_until(all_, kLimit_s, holds)) {
      ADD_FAILURE() << "in vain waited for: " << what << "\n"
                    << r1_.latest("radio") << "\n"
                    << r1_.log() << r2_.log() << r3_.log();
    }
    return (monotonic_now() - start).seconds();
  }
  void listen_for(double seconds) {
    (void)listen_until(all_, seconds, [] { return false; });
  }
  // The thread of its network has sent, told so, and sent again: what it was handed before is in
  // use.
  void wait_until_taken(const SimDaemon& daemon) {
    const auto sent = [&] { return daemon.latest("radio")["udp"]["sent"].get<std::uint64_t>(); };
    for (int round = 0; round < 2; ++round) {
      const std::uint64_t before = sent();
      wait_for("datagrams", [&] { return sent() > before; });
    }
  }
  // All daemons read the key file again.
  void spread_keys() {
    const std::string keys = keys_text(*read_fleet_keys(key_file()));
    for (SimDaemon* daemon : all_) {
      daemon->hang_up();
      wait_for("the new key", [&] { return daemon->logged("fleet key read again: " + keys); });
      wait_until_taken(*daemon);
    }
  }
  std::uint64_t verified() const {
    std::uint64_t sum = 0;
    for (const SimDaemon* daemon : all_) {
      sum += daemon->latest("radio")["link"]["verified"].get<std::uint64_t>();
    }
    return sum;
  }

  SimDaemon r1_ = robot(1);
  SimDaemon r2_ = robot(2);
  SimDaemon r3_ = robot(3);
  const Daemons all_ = {&r1_, &r2_, &r3_};
};

TEST_F(FleetNetworkTest, ThreeRobotsBuildOneMapForLittle) {
  WireTap tap;
  ASSERT_TRUE(tap.open(world_)) << "the switch cannot be listened to";
  const Time started = monotonic_now();
  ASSERT_TRUE(start_all()) << r1_.log() << r2_.log() << r3_.log();

  // They drive at 0.5 m/s for the better part of a minute.
  constexpr double kLead_s = 10.0;
  constexpr double kSteady_s = 30.0;
  listen_for(kLead_s);
  const Time begin = monotonic_now();
  std::array<WireCount, 4> before;
  for (int i = 1; i <= 3; ++i) before[static_cast<std::size_t>(i)] = tap.of(i);
  Time merged;
  const auto note_merged = [&] {
    if (merged == Time{} && all_merged()) merged = monotonic_now();
    return merged != Time{};
  };
  (void)listen_until(all_, kSteady_s, [&] {
    (void)note_merged();
    return false;
  });
  const double steady_s = (monotonic_now() - begin).seconds();
  for (int i = 1; i <= 3; ++i) {
    const WireCount& then = before[static_cast<std::size_t>(i)];
    const double rate_Bps = static_cast<double>(tap.of(i).bytes - then.bytes) / steady_s;
    print_figure("three daemons over UDP: r%d sends %.2f kB/s while it maps at 0.5 m/s", i,
                 rate_Bps / 1e3);
    EXPECT_GT(tap.of(i).bytes, then.bytes);
    EXPECT_LE(rate_Bps, 4000.0);
  }
  wait_for("six merges", note_merged);
  print_figure("three daemons over UDP: all merged %.0f s after their start",
               (merged - started).seconds());
  for (std::size_t a = 1; a <= 3; ++a) {
    for (std::size_t b = 1; b <= 3; ++b) {
      if (a != b) expect_true(*all_[a - 1], *all_[b - 1], a, b);
    }
  }

  // One cable is pulled: the other two go on hearing each other, and the third is in step again
  // when it is back.
  ASSERT_TRUE(world_.pull_cable(3));
  wait_for("silence of r3 alone", [&] {
    return age_s(r1_, r3_) > 5.0 && age_s(r2_, r3_) > 5.0 && age_s(r1_, r2_) < 3.0 &&
           age_s(r2_, r1_) < 3.0;
  });
  EXPECT_TRUE(r1_.merged("r3") && r3_.merged("r1"));
  ASSERT_TRUE(world_.plug_cable(3));
  const double back_s = wait_for("all in step again", [&] {
    return age_s(r1_, r3_) < 3.0 && age_s(r3_, r1_) < 3.0 && all_complete();
  });
  print_figure("three daemons over UDP: in step %.1f s after the cable is back", back_s);

  // Another key, in two rounds, without a gap: nobody has to be verified again.
  const std::uint64_t before_keys = verified();
  ASSERT_TRUE(rotate_fleet_key(key_file()).ok());
  const std::string fresh = hint_text(key_hint(read_fleet_keys(key_file())->current));
  ASSERT_TRUE(swap_fleet_keys(key_file()).ok());
  spread_keys();
  ASSERT_TRUE(swap_fleet_keys(key_file()).ok());
  spread_keys();
  ASSERT_EQ(keys_text(*read_fleet_keys(key_file())).substr(0, 4), fresh);
  wait_for("all in step with the new key", [&] {
    return age_s(r1_, r2_) < 3.0 && age_s(r2_, r3_) < 3.0 && age_s(r3_, r1_) < 3.0 &&
           all_complete();
  });
  EXPECT_EQ(verified(), before_keys);
  for (const SimDaemon* daemon : all_) EXPECT_EQ(daemon->rejected("other_key"), 0u);

  for (SimDaemon* daemon : all_) EXPECT_EQ(daemon->stop(), 0);
  for (int i = 1; i <= 3; ++i) {
    print_figure("three daemons over UDP: r%d never sends more than %.1f kB in a second", i,
                 static_cast<double>(tap.of(i).busiest_second_bytes) / 1e3);
    EXPECT_LE(static_cast<double>(tap.of(i).busiest_second_bytes), kCap_Bps);
  }
  EXPECT_EQ(tap.missed(), 0u);
}

// One has mapped alone for a while; then somebody comes and wants all of it.
TEST_F(FleetNetworkTest, ANewcomerIsServedAtTheCap) {
  constexpr double kLowCap_Bps = 5000.0;
  constexpr int kLandmarks = 150;  // more than a second's worth
  WireTap tap;
  ASSERT_TRUE(tap.open(world_)) << "the switch cannot be listened to";
  SimDaemon r1 = robot(1, "max_rate = 5000\nnews_rate = 2500\n");
  SimDaemon r2 = robot(2);
  ASSERT_TRUE(r1.start()) << r1.log();
  ASSERT_TRUE(listen_until({&r1}, kLimit_s, [&] {
    const auto health = r1.latest("health");
    return !health.is_null() && health["map"]["promoted"].get<int>() > kLandmarks;
  })) << r1.log();
  const WireCount alone = tap.of(1);
  const Time began = monotonic_now();
  ASSERT_TRUE(r2.start()) << r2.log();
  ASSERT_TRUE(listen_until({&r1, &r2}, kLimit_s, [&] { return complete(r2, r1); })) << r2.log();
  const WireCount sent = tap.of(1);
  const double took_s = (monotonic_now() - began).seconds();
  print_figure(
      "two daemons over UDP: a map of %d landmarks is there after %.1f s; with a cap of %.1f kB/s "
      "at most %.2f kB leave in a second",
      r2.peer("r1")["landmarks"].get<int>(), took_s, kLowCap_Bps / 1e3,
      static_cast<double>(sent.busiest_second_bytes) / 1e3);
  EXPECT_GT(static_cast<double>(sent.busiest_second_bytes), 0.7 * kLowCap_Bps);
  // The budget holds when a datagram is handed out; how much later it is on the wire varies with
  // what else the machine does: two seconds' worth may meet there, but no more comes after all.
  EXPECT_LE(static_cast<double>(sent.busiest_second_bytes), 2.0 * kLowCap_Bps);
  EXPECT_LE(static_cast<double>(sent.bytes - alone.bytes), (took_s + 1.0) * kLowCap_Bps);
  EXPECT_EQ(r1.stop(), 0);
  EXPECT_EQ(tap.missed(), 0u);
}

TEST_F(FleetNetworkTest, MergesThroughANetworkThatLosesAThird) {
  std::vector<std::unique_ptr<LossyWire>> wires;
  for (int i = 1; i <= 3; ++i) {
    ASSERT_TRUE(world_.on(i, [&] { wires.push_back(std::make_unique<LossyWire>("wlan0", 0.33)); }));
    if (!wires.back()->works()) {
      GTEST_SKIP()
          << "SKIPPED: this kernel drops no frames for us (XDP); nothing was tested over a "
             "lossy network";
    }
  }
  WireTap tap;
  ASSERT_TRUE(tap.open(world_)) << "the switch cannot be listened to";
  ASSERT_TRUE(start_all()) << r1_.log() << r2_.log() << r3_.log();
  const double took_s = wait_for("six merges", [&] { return all_merged(); });
  const auto heard = r1_.latest("radio")["udp"]["received"].get<double>();
  const double share = heard / static_cast<double>(tap.of(2).datagrams + tap.of(3).datagrams);
  print_figure("three daemons over UDP: r1 hears %.0f %% of what the others send", 100.0 * share);
  EXPECT_LT(share, 0.8);
  print_figure("three daemons over UDP: all merged after %.0f s while a third of all is lost",
               took_s);
  for (std::size_t a = 1; a <= 3; ++a) {
    for (std::size_t b = 1; b <= 3; ++b) {
      if (a != b) expect_true(*all_[a - 1], *all_[b - 1], a, b);
    }
  }
  wires.clear();
  wait_for("all in step", [&] { return all_complete(); });
  for (SimDaemon* daemon : all_) EXPECT_EQ(daemon->stop(), 0);
}

}  // namespace
}  // namespace zenith
