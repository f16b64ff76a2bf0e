#pragma once
// Robots that exchange maps over the simulated network: a Synchroniser each, in a frame that stands
// for the sealed one (48 bytes, a hash for the tag), and what each took of its peers.

#include <map>
#include <memory>
#include <unordered_map>
#include <vector>

#include "sim/network.h"
#include "slam/exchange/synchroniser.h"
#include "tests/support/arena_block.h"

namespace zenith::exchange {

using RecordMap = std::unordered_map<std::uint32_t, LandmarkRecord>;

// As it comes out of the wire. The revision is the wire's own.
LandmarkRecord as_told(const LandmarkRecord& record);
// All fields but the revision.
bool same_record(const LandmarkRecord& a, const LandmarkRecord& b);
// A landmark of the given number of looks somewhere in a hall.
LandmarkRecord made_up_record(Random& random, std::uint32_t id, int looks = kPublishedAppearances);

class FleetNode final : public sim::NetworkNode, public RecordSink {
 public:
  FleetNode(int number, const Settings& settings);

  // The own robot.
  void set(const LandmarkRecord& record);
  void remove(std::uint32_t id);
  void begin_anew(std::uint32_t map);
  const RecordMap& own() const { return own_; }
  Synchroniser& sync() { return sync_; }
  std::size_t memory_bytes() const { return memory_bytes_; }
  std::uint32_t map() const { return map_; }
  std::uint64_t robot() const { return robot_; }
  std::uint64_t damaged() const { return damaged_; }
  // The program ends and starts again, without its map or its peers.
  void restart(const Settings& settings);
  // Off: hears nothing, says nothing.
  void switch_on(bool on) { on_ = on; }
  double forget_after_s = 30.0;  // of silence
  std::size_t sink_room = 100000;
  bool checks_tags = true;  // no: damaged datagrams go on to receive()

  // What it has of a peer's map; null: no such slot.
  const RecordMap* replica(std::uint64_t robot, std::uint32_t map);
  bool complete(std::uint64_t robot, std::uint32_t map);

  void receive(Time now, int from, std::span<const std::uint8_t> bytes) override;
  bool send(Time now, sim::Datagram& out) override;
  Time next_time(Time now) override;
  std::size_t room(int) override { return sink_room; }
  void take(int slot, const LandmarkRecord& record) override;
  void forget(int slot) override { taken_[static_cast<std::size_t>(slot)].clear(); }

 private:
  struct Heard {
    bool joined = false;
    std::uint64_t boot = 0;
    Time at;
    std::uint64_t highest = 0;
    std::uint64_t window = 0;  // of 64, as replay protection
  };
  int session_of(int node) const { return node < number_ ? node : node - 1; }
  int slot_with(std::uint64_t robot, std::uint32_t map) const;
  bool is_fresh(Heard& heard, std::uint64_t counter) const;

  int number_;
  std::uint64_t robot_;
  std::uint64_t boot_ = 1;
  std::uint64_t counter_ = 0;
  std::uint32_t map_ = 0;
  bool on_ = true;
  std::uint64_t damaged_ = 0;
  std::size_t memory_bytes_ = 0;
  Synchroniser sync_;
  std::unique_ptr<ArenaBlock> memory_;
  RecordMap own_;
  std::array<RecordMap, kMaxReplicas> taken_;
  std::array<Heard, kMaxSessions> heard_;
};

struct Fleet {
  // Robots get the numbers 1000, 1001, ...; their maps begin with 10 * robot.
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

Settings fleet_settings(int number, std::uint64_t seed, Settings settings = {});

}  // namespace zenith::exchange
