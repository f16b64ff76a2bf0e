// What one datagram costs: hostile ones in particular, for nobody can keep them from coming. The
// mark: below 5 us whatever is wrong with it.

#include <benchmark/benchmark.h>

#include <memory>
#include <vector>

#include "tests/support/link_rig.h"

namespace zenith {
namespace {

// A robot with a whole fleet of peers, the last of whom speaks.
struct Fleet {
  Fleet() {
    for (std::uint64_t i = 0; i < kMaxSessions; ++i) {
      peer = std::make_unique<TestRobot>("r" + std::to_string(i), 10 + i, 5);
      verify(robot, *peer, at(static_cast<double>(i)));
    }
  }
  Datagram largest() { return peer->say(std::vector<std::uint8_t>(kMaxPayloadBytes)); }

  TestRobot robot{"ada", 1, 1};
  std::unique_ptr<TestRobot> peer;
};

void receive(benchmark::State& state, Fleet& fleet, const Datagram& datagram, Rejected expected) {
  const std::uint64_t before = fleet.robot.rejected(expected);
  for (auto _ : state) {
    benchmark::DoNotOptimize(fleet.robot.hear(at(100), address_of(9), datagram));
  }
  if (fleet.robot.rejected(expected) - before != static_cast<std::uint64_t>(state.iterations())) {
    state.SkipWithError("rejected for another reason");
  }
}

void BM_RejectForeign(benchmark::State& state) {
  Fleet fleet;
  receive(state, fleet, Datagram(kMaxDatagramBytes, 0x33), Rejected::kForeign);
}
BENCHMARK(BM_RejectForeign);

void BM_RejectOtherKey(benchmark::State& state) {
  Fleet fleet;
  Datagram datagram = fleet.largest();
  datagram[6] ^= 1;
  receive(state, fleet, datagram, Rejected::kOtherKey);
}
BENCHMARK(BM_RejectOtherKey);

// The right hint, an invented sender: its key is derived, and the whole datagram looked at.
void BM_RejectForgedStranger(benchmark::State& state) {
  Fleet fleet;
  Datagram datagram = fleet.largest();
  datagram[16] ^= 1;
  receive(state, fleet, datagram, Rejected::kForged);
}
BENCHMARK(BM_RejectForgedStranger);

void BM_RejectForgedPeer(benchmark::State& state) {
  Fleet fleet;
  Datagram datagram = fleet.largest();
  datagram.back() ^= 1;
  receive(state, fleet, datagram, Rejected::kForged);
}
BENCHMARK(BM_RejectForgedPeer);

void BM_RejectRepeated(benchmark::State& state) {
  Fleet fleet;
  const Datagram datagram = fleet.largest();
  fleet.robot.hear(at(99), fleet.peer->address, datagram);
  receive(state, fleet, datagram, Rejected::kRepeated);
}
BENCHMARK(BM_RejectRepeated);

// Recorded in the sender's last boot: the tag is right.
void BM_RejectUnverified(benchmark::State& state) {
  Fleet fleet;
  TestRobot stranger("stranger", 900, 9);
  std::vector<std::uint8_t> payload(kMaxPayloadBytes);
  payload[0] = 99;
  payload[1] = (kMaxPayloadBytes - 3) & 0xFF;
  payload[2] = (kMaxPayloadBytes - 3) >> 8;
  receive(state, fleet, stranger.say(payload), Rejected::kUnverified);
}
BENCHMARK(BM_RejectUnverified);

void BM_Seal(benchmark::State& state) {
  TestRobot robot("ada", 1, 1);
  const std::vector<std::uint8_t> payload(kMaxPayloadBytes);
  std::array<std::uint8_t, kMaxDatagramBytes> datagram;
  for (auto _ : state) benchmark::DoNotOptimize(robot.sessions.seal(payload, datagram));
}
BENCHMARK(BM_Seal);

// As above, by a peer's fresh datagram.
void BM_SealAndOpen(benchmark::State& state) {
  Fleet fleet;
  std::vector<std::uint8_t> payload(kMaxPayloadBytes);
  payload[0] = 99;
  payload[1] = (kMaxPayloadBytes - 3) & 0xFF;
  payload[2] = (kMaxPayloadBytes - 3) >> 8;
  for (auto _ : state) {
    if (!fleet.robot.hear(at(100), fleet.peer->address, fleet.peer->say(payload))) {
      state.SkipWithError("not taken");
    }
  }
}
BENCHMARK(BM_SealAndOpen);

}  // namespace
}  // namespace zenith
