#pragma once
// Somebody on the robots' network who means them ill, with or without their key.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "drivers/radio/udp_radio.h"
#include "platform/base/random.h"
#include "platform/link/peer_exchange.h"
#include "platform/linux/unique_fd.h"

namespace zenith {

class Hostile {
 public:
  using Datagram = std::vector<std::uint8_t>;

  // To be made where its sockets shall be. `victim`: "10.77.0.1:21474". `victims_sockets`: the
  // kernel's list of them, /proc/thread-self/net/udp opened on the victim's computer.
  Hostile(const std::string& victim, UniqueFd victims_sockets, std::uint64_t seed);

  bool open() { return radio_->open().ok(); }
  // Everything that goes through the group for a while, and until there are so many.
  std::vector<Datagram> record(Duration time, std::size_t least);

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
  // With the key, and verified as the robot "mallory": records at the end of all numbers, once the
  // victim knows it. False when the victim does not verify it.
  bool tell_extremes(const FleetKeys& keys, std::uint64_t victim_robot,
                     const std::function<bool()>& is_known);

 private:
  void send(std::span<const std::uint8_t> datagram);
  bool victim_has_taken_all() const;

  Endpoint victim_;
  UniqueFd victims_sockets_;
  std::unique_ptr<UdpRadio> radio_;
  Random random_;
};

}  // namespace zenith
