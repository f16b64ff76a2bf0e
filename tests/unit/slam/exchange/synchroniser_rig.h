#pragma once
// One Synchroniser, a sink that remembers, and peers whose payloads are written by hand.

#include <map>
#include <memory>
#include <vector>

#include "slam/exchange/checksum.h"
#include "slam/exchange/records_section.h"
#include "slam/exchange/synchroniser.h"
#include "tests/support/arena_block.h"

namespace zenith::exchange {

inline LandmarkRecord rig_landmark(std::uint32_t id, float x_m = 1.0F) {
  LandmarkRecord r;
  r.id = id;
  r.x_m = x_m;
  r.covariance_m2 = {1e-4F, 0.0F, 0.0F, 1e-4F, 0.0F, 1e-4F};
  return r;
}

class MemorySink final : public RecordSink {
 public:
  std::size_t room(int) override { return room_left; }
  void take(int slot, const LandmarkRecord& record) override {
    if (room_left > 0) --room_left;
    if (record.removed) {
      maps[slot].erase(record.id);
    } else {
      maps[slot][record.id] = record;
    }
  }
  void forget(int slot) override {
    maps[slot].clear();
    ++forgotten;
  }

  std::size_t room_left = 1000000;
  int forgotten = 0;
  std::map<int, std::map<std::uint32_t, LandmarkRecord>> maps;
};

// Writes one payload.
struct Payload {
  // Copies share it.
  std::shared_ptr<std::vector<std::uint8_t>> bytes =
      std::make_shared<std::vector<std::uint8_t>>(60000);
  ByteWriter out{*bytes};

  Payload& state(std::uint32_t map, std::uint32_t head, std::uint32_t present,
                 std::uint64_t checksum) {
    StateNotice s;
    s.map = map;
    s.head = head;
    s.present = present;
    s.checksum = checksum;
    append(out, s);
    return *this;
  }
  // Records with id = revision + `id_offset`, or as given.
  Payload& records(std::uint32_t map, Range range, std::uint32_t id_offset = 0, float x_m = 1.0F) {
    RecordsWriter writer(out, map, range.first);
    for (std::uint32_t r = range.first; r <= range.last; ++r) {
      EncodedRecord encoded;
      encode_record(rig_landmark(r + id_offset, x_m), encoded);
      writer.add(encoded, r);
    }
    writer.finish(range.last);
    return *this;
  }
  Payload& covered(std::uint32_t map, Range range) {
    RecordsWriter writer(out, map, range.first);
    writer.finish(range.last);
    return *this;
  }
  Payload& request(std::uint64_t robot, std::uint32_t map, Range range) {
    Request r;
    r.robot = robot;
    r.map = map;
    r.ranges.push_back(range);
    append(out, r);
    return *this;
  }
  Bytes written() const { return out.written(); }
};

struct SynchroniserRig {
  explicit SynchroniserRig(Settings s = {})
      : memory([this](Arena& arena) { sync.layout(arena); }), settings(s) {
    settings.robot = 500;
    settings.map = 5;
    settings.name.name.push_back('n');
    sync.configure(settings);
  }

  static Time at(double s) { return Time{} + Duration::from_seconds(s); }
  Verdict hear(int session, const Payload& payload) {
    return sync.receive(at(now_s), session, ++counter, payload.written(), sink);
  }
  // All that is sent at once; counts the sections of each type.
  struct Sent {
    int to = 0;
    std::vector<std::uint8_t> payload;
  };
  std::vector<Sent> send() {
    std::vector<Sent> all;
    std::vector<std::uint8_t> room(kMaxPayload);
    while (true) {
      const Outgoing o = sync.next(at(now_s), room);
      if (o.size == 0) return all;
      all.push_back({o.to, {room.begin(), room.begin() + static_cast<std::ptrdiff_t>(o.size)}});
      EXPECT_TRUE(well_formed(all.back().payload));
    }
  }
  // What was sent until then, in steps of 10 ms.
  std::vector<Sent> run_until(double end_s) {
    std::vector<Sent> all;
    for (; now_s < end_s; now_s += 0.01) {
      for (Sent& sent : send()) all.push_back(std::move(sent));
    }
    return all;
  }
  // The bodies of all sections of one type, with whom they were sent to.
  static std::vector<Sent> sections(const std::vector<Sent>& sent, SectionType type) {
    std::vector<Sent> bodies;
    for (const Sent& s : sent) {
      SectionReader reader(s.payload);
      Section section;
      while (reader.next(section)) {
        if (section.is(type)) {
          bodies.push_back({s.to, {section.body.begin(), section.body.end()}});
        }
      }
    }
    return bodies;
  }

  Synchroniser sync;
  ArenaBlock memory;
  Settings settings;
  MemorySink sink;
  double now_s = 100.0;
  std::uint64_t counter = 0;
};

}  // namespace zenith::exchange
