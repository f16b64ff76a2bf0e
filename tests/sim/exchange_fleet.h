#pragma once
// Robots that exchange maps over the simulated network, as the daemon does: sealed datagrams of a
// PeerExchange each, and what each took of its peers.

#include <array>
#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "platform/link/peer_exchange.h"
#include "sim/network.h"
#include "tests/support/link_rig.h"

namespace zenith::exchange {

using RecordMap = std::unordered_map<std::uint32_t, LandmarkRecord>;

// As it comes out of the wire. The revision is the wire's own.
LandmarkRecord as_told(const LandmarkRecord& record);
// All fields but the revision.
bool same_record(const LandmarkRecord& a, const LandmarkRecord& b);
// A landmark of the given number of looks somewhere in a hall.
LandmarkRecord made_up_record(Random& random, std::uint32_t id, int looks = kPublishedAppearances);

// The robot "robot-N", at address_of(N + 1).
class FleetNode final : public sim::NetworkNode, public RecordSink {
 public:
  // Its map is 10 * (1000 + number) unless the settings have one.
  FleetNode(int number, std::uint64_t seed, const Settings& settings = {});

  // The own robot.
  void set(const LandmarkRecord& record);
  void remove(std::uint32_t id);
  void begin_anew(std::uint32_t map);
  const RecordMap& own() const { return own_; }
  PeerExchange& link() { return *link_; }
  Synchroniser& sync() { return link_->synchroniser(); }
  std::string name() const { return "robot-" + std::to_string(number_); }
  Endpoint address() const { return address_of(static_cast<std::uint8_t>(number_ + 1)); }
  std::size_t memory_bytes() const { return PeerExchange::memory_table().total(); }
  std::uint32_t map() const { return map_; }
  std::uint64_t robot() const { return link_->sessions().own().robot; }
  std::uint64_t rejected(Rejected reason) const {
    return link_->sessions().counters().rejected[static_cast<std::size_t>(reason)];
  }
  // The program ends and starts again, without its map or its peers; with a boot of its own.
  void restart(std::uint32_t map);
  // Off: hears nothing, says nothing.
  void switch_on(bool on) { on_ = on; }
  std::size_t sink_room = 100000;
  bool keeps_sent = false;
  std::vector<Datagram> sent;  // when they are kept

  // The slot of a peer's map, or -1.
  int slot_of(std::uint64_t robot, std::uint32_t map) const;
  int slot_of(const FleetNode& peer) const { return slot_of(peer.robot(), peer.map()); }
  // What it has of a peer's map; null: no such slot.
  const RecordMap* replica(std::uint64_t robot, std::uint32_t map) const;
  const RecordMap* replica(const FleetNode& peer) const {
    return replica(peer.robot(), peer.map());
  }
  bool complete(const FleetNode& peer) const;

  void receive(Time now, int from, std::span<const std::uint8_t> bytes) override;
  bool send(Time now, sim::Datagram& out) override;
  Time next_time(Time now) override;
  std::size_t room(int) override { return sink_room; }
  void take(int slot, const LandmarkRecord& record) override;
  void forget(int slot) override { taken_[static_cast<std::size_t>(slot)].clear(); }

 private:
  int number_;
  std::uint64_t seed_;
  std::uint64_t boot_;
  Settings settings_;
  std::uint32_t map_ = 0;
  bool on_ = true;
  Time next_care_;
  std::unique_ptr<PeerExchange> link_;
  RecordMap own_;
  std::array<RecordMap, kMaxReplicas> taken_;
};

struct Fleet {
  Fleet(int robots, std::uint64_t seed, const Settings& settings = {});

  FleetNode& node(int i) { return *nodes[static_cast<std::size_t>(i)]; }
  int size() const { return static_cast<int>(nodes.size()); }
  // "" when every replica is its owner's map, record by record; else the first difference.
  std::string first_difference();
  // Runs until there is none, at most so long; returns the seconds that it took.
  double run_until_same(double at_most_s, double step_s = 0.25);

  sim::Network network;
  Random random;
  std::vector<std::unique_ptr<FleetNode>> nodes;
};

}  // namespace zenith::exchange
