#include "tests/sim/exchange_fleet.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "slam/exchange/record_code.h"

namespace zenith::exchange {
namespace {

constexpr std::size_t kHeader = 32;
constexpr std::size_t kTag = 16;
constexpr std::uint64_t kTagEnd = 0x5A4E5A4E5A4E5A4EU;

std::uint64_t hash(Bytes bytes) {
  std::uint64_t h = 0xcbf29ce484222325U;  // FNV-1a
  for (const std::uint8_t byte : bytes) h = (h ^ byte) * 0x100000001b3U;
  return h;
}

}  // namespace

LandmarkRecord as_told(const LandmarkRecord& record) {
  EncodedRecord encoded;
  LandmarkRecord told;
  if (!encode_record(record, encoded)) return told;
  ByteReader in(encoded.bytes());
  decode_record(in, 1, told);
  return told;
}

bool same_record(const LandmarkRecord& a, const LandmarkRecord& b) {
  if (a.id != b.id || a.removed != b.removed || a.x_m != b.x_m || a.y_m != b.y_m ||
      a.z_m != b.z_m || a.covariance_m2 != b.covariance_m2 || a.observations != b.observations ||
      a.appearance_count != b.appearance_count) {
    return false;
  }
  for (std::size_t i = 0; i < a.appearance_count; ++i) {
    if (a.appearances[i].descriptor != b.appearances[i].descriptor ||
        a.appearances[i].direction_rad != b.appearances[i].direction_rad) {
      return false;
    }
  }
  return true;
}

LandmarkRecord made_up_record(Random& random, std::uint32_t id, int looks) {
  LandmarkRecord r;
  r.id = id;
  r.x_m = static_cast<float>(random.uniform(-30.0, 30.0));
  r.y_m = static_cast<float>(random.uniform(-30.0, 30.0));
  r.z_m = static_cast<float>(random.uniform(2.0, 4.0));
  const auto variance = static_cast<float>(random.uniform(1e-4, 1e-3));
  r.covariance_m2 = {variance, 0.3F * variance, 0.0F, variance, 0.0F, 2.0F * variance};
  r.observations = static_cast<std::uint16_t>(random.below(300));
  r.appearance_count = static_cast<std::uint8_t>(looks);
  for (int i = 0; i < looks; ++i) {
    AppearanceRecord& look = r.appearances[static_cast<std::size_t>(i)];
    look.direction_rad = static_cast<float>(random.uniform(-3.14, 3.14));
    for (std::int8_t& v : look.descriptor) {
      v = static_cast<std::int8_t>(static_cast<int>(random.below(253)) - 126);
    }
  }
  return r;
}

FleetNode::FleetNode(int number, const Settings& settings)
    : number_(number), robot_(settings.robot) {
  restart(settings);
}

void FleetNode::restart(const Settings& settings) {
  map_ = settings.map;
  ++boot_;
  counter_ = 0;
  own_.clear();
  for (RecordMap& taken : taken_) taken.clear();
  heard_ = {};
  sync_ = Synchroniser{};
  memory_ = std::make_unique<ArenaBlock>([this](Arena& arena) {
    sync_.layout(arena);
    memory_bytes_ = arena.used();
  });
  sync_.configure(settings);
}

void FleetNode::set(const LandmarkRecord& record) {
  if (!sync_.set_own(record)) return;
  own_[record.id] = as_told(record);
}

void FleetNode::remove(std::uint32_t id) {
  LandmarkRecord r;
  r.id = id;
  r.removed = true;
  sync_.set_own(r);
  own_.erase(id);
}

void FleetNode::begin_anew(std::uint32_t map) {
  map_ = map;
  own_.clear();
  sync_.reset_own(map);
}

int FleetNode::slot_with(std::uint64_t robot, std::uint32_t map) const {
  for (int slot = 0; slot < kMaxReplicas; ++slot) {
    const PeerStatus& status = sync_.peer(slot);
    if (status.used && status.robot == robot && status.map == map) return slot;
  }
  return -1;
}

const RecordMap* FleetNode::replica(std::uint64_t robot, std::uint32_t map) {
  const int slot = slot_with(robot, map);
  return slot < 0 ? nullptr : &taken_[static_cast<std::size_t>(slot)];
}

bool FleetNode::complete(std::uint64_t robot, std::uint32_t map) {
  const int slot = slot_with(robot, map);
  return slot >= 0 && sync_.peer(slot).complete;
}

bool FleetNode::is_fresh(Heard& heard, std::uint64_t counter) const {
  if (counter > heard.highest) {
    const std::uint64_t ahead = counter - heard.highest;
    heard.window = ahead >= 64 ? 0 : heard.window << ahead;
    heard.window |= 1;
    heard.highest = counter;
    return true;
  }
  const std::uint64_t back = heard.highest - counter;
  if (back >= 64 || (heard.window >> back & 1) != 0) return false;
  heard.window |= std::uint64_t{1} << back;
  return true;
}

void FleetNode::receive(Time now, int from, std::span<const std::uint8_t> bytes) {
  if (!on_ || bytes.size() < kHeader + kTag) return;
  const Bytes sealed = bytes.first(bytes.size() - kTag);
  ByteReader tag(bytes.last(kTag));
  const bool intact = tag.u64() == hash(sealed) && tag.u64() == kTagEnd;
  if (checks_tags && !intact) {
    ++damaged_;
    return;
  }
  ByteReader header(sealed);
  header.u64();
  const std::uint64_t robot = header.u64();
  const std::uint64_t boot = header.u64();
  const std::uint64_t counter = header.u64();
  const int session = session_of(from);
  Heard& heard = heard_[static_cast<std::size_t>(session)];
  if (!heard.joined || heard.boot != boot) {
    heard = {true, boot, now, 0, 0};
    sync_.join(now, session, robot);
  }
  heard.at = now;
  if (is_fresh(heard, counter)) {
    sync_.receive(now, session, counter, sealed.subspan(kHeader), *this);
  }
}

bool FleetNode::send(Time now, sim::Datagram& out) {
  if (!on_) return false;
  for (std::size_t i = 0; i < heard_.size(); ++i) {
    if (!heard_[i].joined || (now - heard_[i].at).seconds() < forget_after_s) continue;
    heard_[i].joined = false;
    sync_.leave(now, static_cast<int>(i));
  }
  std::array<std::uint8_t, kHeader + kMaxPayload + kTag> room = {};
  ByteWriter writer(room);
  writer.u64(0);
  writer.u64(robot_);
  writer.u64(boot_);
  writer.u64(++counter_);
  const Outgoing o = sync_.next(now, std::span<std::uint8_t>(room).subspan(kHeader, kMaxPayload));
  if (o.size == 0) return false;
  const std::size_t sealed = kHeader + o.size;
  ByteWriter tag(std::span<std::uint8_t>(room).subspan(sealed));
  tag.u64(hash(Bytes(room).first(sealed)));
  tag.u64(kTagEnd);
  out.bytes.assign(room.begin(), room.begin() + static_cast<std::ptrdiff_t>(sealed + kTag));
  out.to = o.to == kEverybody ? sim::kAllNodes : (o.to < number_ ? o.to : o.to + 1);
  return true;
}

Time FleetNode::next_time(Time now) {
  return on_ ? sync_.next_time(now) : now + Duration::from_seconds(1.0);
}

void FleetNode::take(int slot, const LandmarkRecord& record) {
  RecordMap& map = taken_[static_cast<std::size_t>(slot)];
  LandmarkRecord& known = map[record.id];
  if (known.revision < record.revision) known = record;  // as PeerMap does
}

Settings fleet_settings(int number, std::uint64_t seed, Settings settings) {
  settings.robot = 1000 + static_cast<std::uint64_t>(number);
  settings.map = static_cast<std::uint32_t>(10 * settings.robot);
  settings.seed = seed;
  settings.name.name.clear();
  for (const char c : "robot-" + std::to_string(number)) settings.name.name.push_back(c);
  return settings;
}

Fleet::Fleet(int robots, std::uint64_t seed, const Settings& settings)
    : network(seed), random(seed, 1) {
  for (int i = 0; i < robots; ++i) {
    nodes.push_back(std::make_unique<FleetNode>(i, fleet_settings(i, seed, settings)));
    network.add(*nodes.back());
  }
}

std::string Fleet::first_difference() {
  for (const auto& owner : nodes) {
    for (const auto& reader : nodes) {
      if (owner == reader) continue;
      const std::string who =
          std::to_string(reader->robot()) + " of " + std::to_string(owner->robot()) + ": ";
      const RecordMap* replica = reader->replica(owner->robot(), owner->map());
      if (replica == nullptr) return who + "no slot";
      std::size_t present = 0;
      for (const auto& [id, record] : *replica) present += record.removed ? 0 : 1;
      if (present != owner->own().size()) {
        return who + std::to_string(present) + " landmarks instead of " +
               std::to_string(owner->own().size());
      }
      for (const auto& [id, record] : owner->own()) {
        const auto it = replica->find(id);
        if (it == replica->end()) return who + "lacks " + std::to_string(id);
        if (!same_record(it->second, record)) return who + "differs in " + std::to_string(id);
      }
    }
  }
  return {};
}

double Fleet::run_until_same(double at_most_s, double step_s) {
  const Time start = network.now();
  while ((network.now() - start).seconds() < at_most_s) {
    network.run_for(step_s);
    if (first_difference().empty()) break;
  }
  return (network.now() - start).seconds();
}

}  // namespace zenith::exchange
