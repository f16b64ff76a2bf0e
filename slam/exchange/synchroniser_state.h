#pragma once
// What a Synchroniser holds; for its own files alone.

#include <array>

#include "platform/base/random.h"
#include "slam/exchange/budget.h"
#include "slam/exchange/own_records.h"
#include "slam/exchange/quarantine.h"
#include "slam/exchange/replica_store.h"
#include "slam/exchange/synchroniser.h"

namespace zenith::exchange {

// A verified (robot, boot).
struct Session {
  bool joined = false;
  Sender sender;
  int slot = -1;  // of the map that it has now

  // Which of its datagrams was newer: those that bore the newest state and the highest revision.
  bool state_heard = false;
  std::uint64_t state_counter = 0;
  std::uint32_t highest = 0;
  std::uint64_t highest_counter = 0;
  std::uint64_t records_counter = 0;  // of its newest datagram with records of the present map
  Time map_began;

  Budget received;
  Intervals<kMaxRangesAsked> wanted;  // of the own revisions
  Time serve_at;
};

// A (robot, boot, map).
struct Slot {
  PeerStatus status;
  bool merged = false;  // the own map is aligned with it
  bool lost = false;    // its list was given up for room; what was taken of it may stay

  // Asking for what is missing.
  bool asking = false;
  bool asked = false;  // since asking began
  bool progress = false;
  std::uint32_t asked_last = 0;
  int fruitless = 0;   // requests in a row of which nothing came
  Duration full_wait;  // what came found no room
  Time due;

  // The checksum.
  bool agreed = false;
  bool doubted = false;  // all is asked for once more
  Time doubt_at;         // not before
  Duration doubt_wait;
};

struct Synchroniser::State {
  void start(const Settings& s);

  std::size_t cost(std::size_t payload, int to) const {
    const std::size_t each = payload + kFrameBytes + settings.headers_below;
    return each * static_cast<std::size_t>(to == kEverybody ? copies : 1);
  }
  // The largest payload that may go out at once; 0: the rate does not suffice for one record.
  std::size_t largest_payload(int to) const;
  void size_budgets();

  // Slots.
  int attach(Time now, Session& from, int session, std::uint32_t map, RecordSink& sink);
  int find_slot(const Sender& sender, std::uint32_t map) const;
  bool is_joined(int session) const {
    return session >= 0 && session < kMaxSessions &&
           sessions[static_cast<std::size_t>(session)].joined;
  }
  int free_slot(RecordSink& sink);
  void clear_slot(int slot, RecordSink& sink);
  bool reclaim_records(std::size_t wanted);

  // Receiving.
  Verdict take_state(Time now, int session, std::uint64_t counter, Bytes body, RecordSink& sink);
  Verdict take_records(Time now, int session, std::uint64_t counter, Bytes body, RecordSink& sink);
  Verdict check_records(int slot, Bytes body, RecordSink& sink);
  void take_request(Time now, Session& from, Bytes body);
  void take_alignments(Slot& slot);
  void compare(Time now, int slot);
  Time ask_at(Time now, std::uint32_t missing);
  Time soon(Time now);
  void look_for_gaps(Time now, int slot, RecordSink& sink);
  void sweep(int slot, RecordSink& sink);
  void fault(Time now, int session, RecordSink& sink);

  // Sending.
  Outgoing sent(Time now, int to, const ByteWriter& out);
  Outgoing send_bye(Time now, std::span<std::uint8_t> out);
  Outgoing send_state(Time now, std::span<std::uint8_t> out);
  std::size_t state_bytes() const;
  StateNotice state_notice();
  Outgoing send_requests(Time now, std::span<std::uint8_t> out);
  bool append_request(Time now, int slot, ByteWriter& out);
  Outgoing send_news(Time now, std::span<std::uint8_t> out, OwnRecords::Queue queue);
  bool news_due(OwnRecords::Queue queue) const;
  void append_news(Time now, ByteWriter& out);
  Outgoing serve(Time now, std::span<std::uint8_t> out);
  int next_to_serve(Time now) const;
  int lacking(std::uint32_t revision) const;
  void served(Range range, int to);
  bool nobody_there() const;

  Settings settings;
  Random random{0};
  OwnRecords own;
  ReplicaStore replicas;
  Quarantine quarantine;
  Counters counters;
  std::array<Session, kMaxSessions> sessions;
  std::array<Slot, kMaxReplicas> slots;

  Pose2 T_start_robot;
  Health health = Health::kStarting;
  FixedVector<OwnAlignment, kMaxReplicas> alignments;
  std::size_t next_alignment = 0;

  Budget all;
  Budget news;  // changes of known landmarks
  int copies = 1;
  bool bye_due = false;
  bool over = false;
  Time state_due;
  bool hello_next = true;
  std::array<std::size_t, 2> flush = {};  // records that go out even when they fill no datagram
  bool serves_next = false;
  int last_served = 0;
};

}  // namespace zenith::exchange
