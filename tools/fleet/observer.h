#pragma once
// Listens to a fleet over its radio: a robot without a map, that gets the maps, poses and
// alignments of all others. Needs the fleet's key.

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "drivers/radio/udp_radio.h"
#include "platform/link/peer_exchange.h"

namespace zenith::tools {

struct ObservedRobot {
  std::string name;
  std::uint64_t robot = 0;
  bool complete = false;  // its map is here as it last told
  exchange::StateNotice state;
  std::map<std::uint32_t, LandmarkRecord> landmarks;  // by id; removed ones are not here
};

class FleetObserver final : private exchange::RecordSink {
 public:
  FleetObserver(const FleetKeys& keys, const RadioSettings& radio);

  Status open() { return radio_.open(); }
  // Listens and answers for so long.
  void run_for(Duration time);
  // Robots that are heard now, by name.
  std::vector<ObservedRobot> robots() const;
  // BYE.
  void leave();

 private:
  std::size_t room(int slot) override;
  void take(int slot, const LandmarkRecord& record) override;
  void forget(int slot) override;
  void send();

  UdpRadio radio_;
  PeerExchange exchange_;
  std::map<int, std::map<std::uint32_t, LandmarkRecord>> maps_;  // by slot
};

}  // namespace zenith::tools
