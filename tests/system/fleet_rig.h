#pragma once
// What tests of a fleet of real daemons share: a network of their own, a key, and the truth.

#include <gtest/gtest.h>

#include <cmath>

#include "platform/link/fleet_key.h"
#include "sim/simulation.h"
#include "tests/support/figure.h"
#include "tests/support/patience.h"
#include "tests/system/net_world.h"
#include "tests/system/sim_daemon.h"

namespace zenith {

// Of three computers. SimDaemon's world has r1, r2, r3.
class FleetRig : public testing::Test {
 protected:
  static constexpr double kLimit_s = kPatience_s;  // what is waited for is a state
  // Of an alignment, between starts that lie up to 7 m apart; five frames a second and half of the
  // usual particles. Measured: 1 to 3 cm, 0.0 to 0.3 degrees.
  static constexpr double kMaxError_m = 0.2;
  static constexpr double kMaxError_rad = 0.05;

  void SetUp() override {
    if (!world_.good()) {
      GTEST_SKIP() << "SKIPPED: network namespaces need root and the ip command; nothing was "
                      "tested between daemons";
    }
    ASSERT_TRUE(create_fleet_key(key_file()).ok());
  }

  std::filesystem::path key_file() const { return folder_.path() / "fleet.key"; }
  // The robot of a computer, on its wireless interface. Peers that are silent are not forgotten: a
  // slow computer makes all of them silent at times.
  SimDaemon robot(int computer, const std::string& more = "") const {
    return SimDaemon(folder_.path(), "r" + std::to_string(computer),
                     "interface = \"wlan0\"\nforget_after_s = 3600\n" + more,
                     world_.name(computer));
  }

  // `own` has all that `peer` has told.
  static bool complete(const SimDaemon& own, const SimDaemon& peer) {
    const auto line = own.peer(peer.name());
    return !line.is_null() && line["complete"].get<bool>();
  }

  // The merge of r<a> with the map of r<b> is where it should be.
  static void expect_true(const SimDaemon& own, const SimDaemon& peer, std::size_t a,
                          std::size_t b) {
    const auto found = own.merged(peer.name());
    ASSERT_TRUE(found) << own.log();
    auto simulation =
        sim::Simulation::load(ZENITH_SOURCE_DIR "/tests/system/worlds/one-room.toml", {});
    ASSERT_TRUE(simulation.ok());
    const Pose2 start_a = simulation->drive(a - 1).T_world_robot(Time{0});
    const Pose2 start_b = simulation->drive(b - 1).T_world_robot(Time{0});
    const Pose2 truth = start_a.inverse() * start_b;
    const double error_m = std::hypot(found->x_m - truth.x_m, found->y_m - truth.y_m);
    const double error_rad = std::abs(wrap_angle(found->theta_rad - truth.theta_rad));
    print_figure("daemons over UDP: %s has %s's start wrong by %.3f m, %.2f deg",
                 own.name().c_str(), peer.name().c_str(), error_m, error_rad * 57.3);
    EXPECT_LT(error_m, kMaxError_m);
    EXPECT_LT(error_rad, kMaxError_rad);
  }

  NetWorld world_{3};
  tools::TemporaryFolder folder_;
};

}  // namespace zenith
