// What comes out of the socket, before and after authentication. The first byte chooses:
//
//   even: the rest is a datagram of somebody without the key: nothing of it is ever fresh
//   odd:  the rest is a payload, sealed by a robot with the key: a verified peer (1, 5, ...) or a
//         stranger (3, 7, ...); from where the peer answers, or (bit 3) from elsewhere
//
// Neither crashes, what a stranger says changes no map, and where nobody has answered nothing is
// sent that is longer than what came from there.

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>

#include "platform/link/peer_exchange.h"
#include "tests/fuzz/require.h"
#include "tests/support/link_rig.h"

using namespace zenith;  // NOLINT(google-build-using-namespace)

namespace {

class CountingSink final : public exchange::RecordSink {
 public:
  std::size_t room(int) override { return 1000; }
  void take(int, const LandmarkRecord&) override { ++taken; }
  void forget(int) override {}
  int taken = 0;
};

PeerExchangeSettings exchange_settings() {
  PeerExchangeSettings settings;
  settings.sessions = session_settings("ada", 1);
  settings.synchroniser.map = 1;
  settings.synchroniser.seed = 1;
  return settings;
}

// One robot with a verified peer; made once, for it takes long.
struct Fixture {
  Fixture() {
    hear(peer.address, peer.hello());
    std::array<std::uint8_t, kMaxDatagramBytes> out;
    for (Dispatch d = robot.next(at(0), out); d.size > 0; d = robot.next(at(0), out)) {
      if (d.to_everybody) continue;
      peer.hear(at(0), address_of(1), Datagram(out.begin(), out.begin() + d.size));
    }
    for (const auto& [to, response] : peer.answers()) hear(peer.address, response);
    require(robot.sessions().find_peer(peer.sessions.own().robot) >= 0);
  }
  void hear(const Endpoint& from, const Datagram& datagram) {
    robot.receive(now, from, datagram, sink);
  }
  // From where nobody answers. What is sent there at once is all that goes there.
  void hear_from_elsewhere(const Datagram& datagram) {
    const Endpoint elsewhere = address_of(9);
    hear(elsewhere, datagram);
    std::array<std::uint8_t, kMaxDatagramBytes> out;
    std::size_t sent = 0;
    for (Dispatch d = robot.next(now, out); d.size > 0; d = robot.next(now, out)) {
      if (!d.to_everybody && d.to == elsewhere) sent += d.size;
    }
    require(sent <= datagram.size());
  }

  Time now = at(0);
  PeerExchange robot{exchange_settings()};
  TestRobot peer{"bert", 2, 2};
  TestRobot stranger{"zoe", 3, 3};
  CountingSink sink;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static auto fixture = std::make_unique<Fixture>();
  if (size == 0) return 0;
  // Before the nanoseconds come to their end, or when the peer has said BYE: another one.
  const bool has_left = fixture->robot.sessions().find_peer(fixture->peer.sessions.own().robot) < 0;
  if (has_left || fixture->now.ns > 4'000'000'000'000'000'000) {
    fixture = std::make_unique<Fixture>();
  }
  const std::uint8_t mode = data[0];
  const std::span<const std::uint8_t> rest(data + 1, size - 1);
  // An hour each: no quarantine of the last input hides this one.
  fixture->now = fixture->now + Duration{3'700'000'000'000};
  const std::uint64_t fresh = fixture->robot.sessions().counters().received;
  const int taken = fixture->sink.taken;
  if (mode % 2 == 0) {
    fixture->hear_from_elsewhere(Datagram(rest.begin(), rest.end()));
    require(fixture->robot.sessions().counters().received == fresh);
    require(fixture->sink.taken == taken);
    return 0;
  }
  const auto payload = rest.first(std::min(rest.size(), kMaxPayloadBytes));
  const bool is_peer = mode % 4 == 1;
  TestRobot& speaker = is_peer ? fixture->peer : fixture->stranger;
  const Datagram datagram = speaker.say({payload.begin(), payload.end()});
  if ((mode & 8u) != 0) {
    fixture->hear_from_elsewhere(datagram);
  } else {
    fixture->hear(speaker.address, datagram);
  }
  if (!is_peer) require(fixture->sink.taken == taken);
  return 0;
}
