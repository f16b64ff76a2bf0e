// What the whole algorithm takes of the memory of a small board, when it is full.

#include <cstdio>
#include <fstream>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "platform/daemon/exchange.h"
#include "platform/daemon/memory_report.h"
#include "platform/link/peer_exchange.h"
#include "tests/memory/heap_guard.h"
#include "tests/support/figure.h"
#include "tests/support/link_rig.h"
#include "tests/support/strip_rig.h"

namespace zenith {
namespace {

constexpr std::size_t kMost = std::size_t{64} << 20U;
constexpr int kLooksTold = kPeerBlockLooks / kPeerBlock;
// More than fit: some are not found, and some give way.
constexpr int kStrip = kMaxLandmarks + 200;

// Of this process, in RAM, and no part of a file: 0 when the kernel does not tell.
std::size_t resident_bytes() {
  std::ifstream file("/proc/self/smaps_rollup");
  for (std::string line; std::getline(file, line);) {
    unsigned long long kib = 0;
    if (std::sscanf(line.c_str(), "Anonymous: %llu kB", &kib) == 1) return kib * 1024;
  }
  return 0;
}

double mib(std::size_t bytes) {
  return static_cast<double>(bytes) / (1024.0 * 1024.0);
}

// The ceiling's landmark `i` as peer `peer` tells of it: in a frame of its own.
LandmarkRecord record_of(const point_world::PointLandmark& l, int i, int peer) {
  LandmarkRecord r;
  r.id = static_cast<std::uint32_t>(i) + 1;
  r.revision = 1;
  r.x_m = static_cast<float>(l.p_m.x()) + 3.0F * static_cast<float>(peer);
  r.y_m = static_cast<float>(l.p_m.y()) - 1.0F;
  r.z_m = static_cast<float>(l.p_m.z());
  r.covariance_m2 = {1e-4F, 0.0F, 0.0F, 1e-4F, 0.0F, 1e-4F};
  r.observations = 20;
  r.appearance_count = kLooksTold;
  for (auto& look : r.appearances) look = {l.compact.values, 0.0F};
  return r;
}

DaemonConfig with_radio() {
  DaemonConfig config;
  config.radio.key_file = "fleet.key";
  return config;
}

TEST(Memory, IsAtMost64MiBByTheTable) {
  const MemoryTable table = daemon_memory(with_radio());
  EXPECT_LE(table.total(), kMost) << memory_text(table);
  print_figure("memory: %.2f MiB in the table, %.2f of them rows of particles", mib(table.total()),
               mib(table.parts()[3].bytes));
  DaemonConfig alone;
  EXPECT_LT(daemon_memory(alone).total(), table.total()) << "without a key there is no exchange";
  DaemonConfig few = with_radio();
  few.slam.particles = 50;
  EXPECT_LT(daemon_memory(few).total(), table.total() / 2 + (table.total() / 4));
}

TEST(Memory, StaysResidentWithin64MiBWhenAllMapsAreFull) {
  if (!HeapGuard::works()) GTEST_SKIP() << "a sanitizer has memory of its own";
  const std::size_t before = resident_bytes();
  if (before == 0) GTEST_SKIP() << "NOT TESTED: the kernel has no /proc/self/smaps_rollup";

  auto rig = std::make_unique<strip::StripRig>(kStrip);
  auto queues = std::make_unique<Exchange>();
  PeerExchangeSettings settings;
  settings.sessions = session_settings("full", 1);
  auto link = std::make_unique<PeerExchange>(settings);
  const auto& ceiling = rig->world().landmarks;
  for (int i = 0; i < kMaxLandmarks; ++i) {
    const auto& landmark = ceiling[static_cast<std::size_t>(i)];
    for (int peer = 0; peer < kWholePeerMaps; ++peer) {
      const LandmarkRecord record = record_of(landmark, i, peer);
      rig->fleet().receive(peer, {&record, 1});
    }
    EXPECT_TRUE(link->synchroniser().set_own(record_of(landmark, i, 0)));
  }
  for (int i = 0; i < 40; ++i) {
    rig->look(rig->next_step());
    rig->update();
    rig->cooperate();
  }
  const std::size_t ceiling_bytes = ceiling.size() * sizeof(ceiling[0]);
  const std::size_t resident = resident_bytes() - before - ceiling_bytes;

  EXPECT_GE(rig->map_size(), kMaxLandmarks - 100);
  for (int peer = 0; peer < kWholePeerMaps; ++peer) {
    const PeerMap& map = rig->fleet().peers()[static_cast<std::size_t>(peer)].map;
    EXPECT_EQ(map.size(), kMaxPeerLandmarks);
    EXPECT_EQ(map.rejected(), 0U);
    EXPECT_EQ(map.looks(kMaxPeerLandmarks - 1).size(), static_cast<std::size_t>(kLooksTold));
  }
  EXPECT_FALSE(rig->fleet().alignments().empty()) << "no peer was searched";
  print_figure("memory: %.2f MiB resident with 200 particles, %d own landmarks, %d peers of %d",
               mib(resident), rig->map_size(), kWholePeerMaps, kMaxPeerLandmarks);
  EXPECT_LE(resident, kMost);
  EXPECT_GE(resident, daemon_memory(with_radio()).total() * 9 / 10) << "less than was laid out";
}

}  // namespace
}  // namespace zenith
