// Verified peers that send anything, in any order, while the own map changes. After each step:
// what the sink holds is what the synchroniser says, payloads are well-formed, the cap is kept.
//
// The input is a row of steps: what, session, and what the step needs; see step().

#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <unordered_set>
#include <vector>

#include "slam/exchange/records_section.h"
#include "slam/exchange/synchroniser.h"
#include "tests/fuzz/require.h"
#include "tests/support/arena_block.h"

using namespace zenith;            // NOLINT(google-build-using-namespace)
using namespace zenith::exchange;  // NOLINT(google-build-using-namespace)

namespace {

constexpr int kSessions = 4;
constexpr int kSlots = 6;
constexpr std::uint32_t kCap = 20'000;

class Sink final : public RecordSink {
 public:
  std::size_t room(int slot) override {
    require(slot >= 0 && slot < kSlots);
    return room_left;
  }
  void take(int slot, const LandmarkRecord& r) override {
    require(room_left > 0);
    --room_left;
    require(r.revision > 0);
    for (const float p : {r.x_m, r.y_m, r.z_m}) require(std::isfinite(p));
    for (const float c : r.covariance_m2) require(std::isfinite(c));
    require(r.appearance_count <= kPublishedAppearances);
    auto& map = maps[static_cast<std::size_t>(slot)];
    r.removed ? void(map.erase(r.id)) : void(map.insert(r.id));
  }
  void forget(int slot) override { maps[static_cast<std::size_t>(slot)].clear(); }

  std::size_t room_left = 1000;
  std::array<std::unordered_set<std::uint32_t>, kSlots> maps;
};

// Laid out once: that takes longer than a run.
struct Laid {
  Synchroniser sync;
  ArenaBlock memory{[this](Arena& arena) { sync.layout(arena); }};
};

class Run {
 public:
  Run(Bytes input, Synchroniser& sync) : in_(input), sync_(sync) {
    Settings settings;
    settings.robot = 1;
    settings.map = 1;
    settings.name.name.push_back('f');
    settings.max_rate = kCap;
    settings.news_rate = kCap / 2;
    settings.peer_rate = 100'000;
    settings.slots = kSlots;
    sync_.configure(settings);
  }

  void all() {
    for (int i = 0; i < 200 && in_.left() > 0; ++i) {
      step();
      check();
    }
  }

 private:
  void step() {
    const std::uint8_t what = in_.u8();
    const int session = in_.u8() % kSessions;
    switch (what % 8) {
      case 0:
        joined_[static_cast<std::size_t>(session)] = true;
        counter_ = 0;
        sync_.join(now_, session, {10 + (what >> 3u) % 3u, 20 + (what >> 5u) % 2u, 0});
        break;
      case 1:
        joined_[static_cast<std::size_t>(session)] = false;
        sync_.leave(now_, session);
        break;
      case 2:
        now_ = now_ + Duration{static_cast<std::int64_t>(in_.u16()) * 1'000'000};
        break;
      case 3:
        set_own();
        break;
      case 4:
        sink_.room_left = in_.u16();
        break;
      case 5:
        if (what >= 128) sync_.reset_own(in_.u8());
        sync_.set_copies_to_everybody(1 + session);
        break;
      default:
        receive(session, what % 8 == 6);
    }
  }

  void set_own() {
    LandmarkRecord r;
    r.id = in_.u8();
    r.removed = in_.u8() % 4 == 0;
    r.x_m = static_cast<float>(in_.i24()) * 0.01F;
    r.covariance_m2 = {0.1F, 0.0F, 0.0F, 0.1F, 0.0F, 0.1F};
    r.appearance_count = in_.u8() % 9;
    sync_.set_own(r);
  }

  // A section with a length that fits, or a payload as it is.
  void receive(int session, bool wrap) {
    if (!joined_[static_cast<std::size_t>(session)]) return;
    const std::uint64_t counter = counter_ + in_.u8() % 4;
    counter_ = std::max(counter_, counter);
    const std::uint8_t type = wrap ? in_.u8() : 0;
    const std::size_t length = in_.u16() % (kMaxPayload - kSectionHeader);
    const Bytes bytes = in_.take(std::min(length, in_.left()));
    std::array<std::uint8_t, kMaxPayload> room = {};
    ByteWriter out(room);
    const std::size_t start = begin_section(out, static_cast<SectionType>(type));
    out.bytes(bytes);
    end_section(out, start);
    const Bytes payload = wrap ? out.written() : bytes;
    const Verdict verdict = sync_.receive(now_, session, counter, payload, sink_);
    if (!well_formed(payload)) {
      require(verdict == Verdict::kMalformed || verdict == Verdict::kTooMuch ||
              verdict == Verdict::kQuarantined);
    }
  }

  void check() {
    std::array<std::uint8_t, kMaxPayload> room = {};
    for (int i = 0; i < 100; ++i) {
      const Outgoing o = sync_.next(now_, room);
      if (o.size == 0) break;
      require(i < 99);
      require(o.size <= kMaxPayload && well_formed(Bytes(room).first(o.size)));
      require(o.to == kEverybody || joined_[static_cast<std::size_t>(o.to)]);
    }
    require(sync_.next_time(now_) > now_);
    keep_cap();
    for (int slot = 0; slot < kMaxReplicas; ++slot) {
      const PeerStatus& peer = sync_.peer(slot);
      if (!peer.used) continue;
      require(slot < kSlots);
      require(peer.landmarks == sink_.maps[static_cast<std::size_t>(slot)].size());
      if (peer.session >= 0) require(sync_.slot_of(peer.session) == slot);
    }
  }

  void keep_cap() {
    const std::uint64_t bytes = sync_.counters().bytes_sent;
    second_.push_back({now_, bytes - sent_});
    in_second_ += bytes - sent_;
    sent_ = bytes;
    while ((now_ - second_.front().first).ns >= 1'000'000'000) {
      in_second_ -= second_.front().second;
      second_.pop_front();
    }
    require(in_second_ <= kCap);
  }

  ByteReader in_;
  Synchroniser& sync_;
  Sink sink_;
  Time now_{1'000'000'000};
  std::uint64_t counter_ = 0;
  std::array<bool, kSessions> joined_ = {};
  std::deque<std::pair<Time, std::uint64_t>> second_;
  std::uint64_t sent_ = 0;
  std::uint64_t in_second_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Laid laid;
  Run(Bytes(data, size), laid.sync).all();
  return 0;
}
