#pragma once
// Somebody on the robots' network who means them ill, with or without their key.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "drivers/radio/udp_radio.h"
#include "platform/base/random.h"
#include "platform/link/peer_exchange.h"

namespace zenith {

class Hostile {
 public:
  using Datagram = std::vector<std::uint8_t>;

  // To be made where its sockets shall be. `victim`: "10.77.0.1:21474".
  Hostile(const std::string& victim, std::uint64_t seed);

  bool open() { return radio_->open().ok(); }
  // Everything that goes through the group for a while.
  std::vector<Datagram> record(Duration time);

  // Each sends to the victim and returns how many datagrams that was.
  std::uint64_t replay(const std::vector<Datagram>& recorded);
  std::uint64_t flip_bits(const std::vector<Datagram>& recorded);
  std::uint64_t truncate(const std::vector<Datagram>& recorded);
  // The header of a real one, all else made up: another counter, boot, version.
  std::uint64_t spoof(const std::vector<Datagram>& recorded);
  // Noise, and noise that begins as a datagram does.
  std::uint64_t flood(std::uint64_t count);

  // With the key: strangers who never answer, other versions.
  std::uint64_t knock(const FleetKeys& keys, std::uint64_t count);
  std::uint64_t speak_other_versions(const FleetKeys& keys, std::uint64_t count);
  // With the key, and verified as the robot "mallory": records at the end of all numbers. False
  // when the victim does not verify it.
  bool tell_extremes(const FleetKeys& keys, std::uint64_t victim_robot);

 private:
  void send(std::span<const std::uint8_t> datagram);

  Endpoint victim_;
  std::unique_ptr<UdpRadio> radio_;
  Random random_;
};

}  // namespace zenith
