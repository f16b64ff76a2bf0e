#include "tests/sim/exchange_fleet.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "slam/exchange/record_code.h"

namespace zenith::exchange {
namespace {

constexpr Duration kCare = Duration::from_seconds(1.0);

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

FleetNode::FleetNode(int number, std::uint64_t seed, const Settings& settings)
    : number_(number), seed_(seed), boot_(1000 * seed), settings_(settings) {
  restart(settings.map != 0 ? settings.map : static_cast<std::uint32_t>(10 * (1000 + number)));
}

void FleetNode::restart(std::uint32_t map) {
  map_ = map;
  own_.clear();
  for (RecordMap& taken : taken_) taken.clear();
  PeerExchangeSettings all;
  all.sessions = session_settings(name(), ++boot_);
  all.synchroniser = settings_;
  all.synchroniser.map = map;
  all.synchroniser.seed = seed_ + boot_;
  link_ = std::make_unique<PeerExchange>(all);
}

void FleetNode::set(const LandmarkRecord& record) {
  if (!sync().set_own(record)) return;
  own_[record.id] = as_told(record);
}

void FleetNode::remove(std::uint32_t id) {
  LandmarkRecord r;
  r.id = id;
  r.removed = true;
  sync().set_own(r);
  own_.erase(id);
}

void FleetNode::begin_anew(std::uint32_t map) {
  map_ = map;
  own_.clear();
  sync().reset_own(map);
}

int FleetNode::slot_of(std::uint64_t robot, std::uint32_t map) const {
  for (int slot = 0; slot < kMaxReplicas; ++slot) {
    const PeerStatus& status = link_->synchroniser().peer(slot);
    if (status.used && status.robot == robot && status.map == map) return slot;
  }
  return -1;
}

const RecordMap* FleetNode::replica(std::uint64_t robot, std::uint32_t map) const {
  const int slot = slot_of(robot, map);
  return slot < 0 ? nullptr : &taken_[static_cast<std::size_t>(slot)];
}

bool FleetNode::complete(const FleetNode& peer) const {
  const int slot = slot_of(peer);
  return slot >= 0 && link_->synchroniser().peer(slot).complete;
}

void FleetNode::receive(Time now, int from, std::span<const std::uint8_t> bytes) {
  if (on_) link_->receive(now, address_of(static_cast<std::uint8_t>(from + 1)), bytes, *this);
}

bool FleetNode::send(Time now, sim::Datagram& out) {
  if (!on_) return false;
  if (now >= next_care_) {
    next_care_ = now + kCare;
    link_->forget_silent(now);
  }
  std::array<std::uint8_t, kMaxDatagramBytes> room;
  const Dispatch dispatch = link_->next(now, room);
  if (dispatch.size == 0) return false;
  out.bytes.assign(room.begin(), room.begin() + static_cast<std::ptrdiff_t>(dispatch.size));
  out.to = dispatch.to_everybody ? sim::kAllNodes : dispatch.to.address[3] - 1;
  if (keeps_sent) sent.push_back(out.bytes);
  return true;
}

Time FleetNode::next_time(Time now) {
  return on_ ? link_->next_time(now) : now + kCare;
}

void FleetNode::take(int slot, const LandmarkRecord& record) {
  RecordMap& map = taken_[static_cast<std::size_t>(slot)];
  LandmarkRecord& known = map[record.id];
  if (known.revision < record.revision) known = record;  // as PeerMap does
}

Fleet::Fleet(int robots, std::uint64_t seed, const Settings& settings)
    : network(seed), random(seed, 1) {
  for (int i = 0; i < robots; ++i) {
    nodes.push_back(std::make_unique<FleetNode>(i, seed, settings));
    network.add(*nodes.back());
  }
}

std::string Fleet::first_difference() {
  for (const auto& owner : nodes) {
    for (const auto& reader : nodes) {
      if (owner == reader) continue;
      const std::string who = reader->name() + " of " + owner->name() + ": ";
      const RecordMap* replica = reader->replica(*owner);
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
