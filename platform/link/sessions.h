#pragma once
// Who is a peer: opens datagrams, challenges whoever is new, keeps for each verified sender the
// window of its counters and where it was last heard from. docs/protocol.md, "Who is believed".
//
// Sans-I/O and of fixed size. One thread at a time. What one datagram costs does not depend on what
// is wrong with it: at most the derivation of a key and one look at all of its bytes.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "platform/base/fixed_vector.h"
#include "platform/base/time.h"
#include "platform/link/handshake.h"
#include "platform/link/link_report.h"
#include "platform/link/replay_window.h"
#include "slam/capacity.h"

namespace zenith {

struct SessionSettings {
  FleetKeys keys;
  RobotName name;
  std::uint64_t boot = 0;  // random, new at each start
  SecretKey secret;        // likewise
  Duration forget_after = {60'000'000'000};
};

struct Session {
  SenderId id;
  RobotName name;    // empty until its HELLO came
  Endpoint address;  // of its newest datagram
  Time verified;
  Time heard;
  bool is_superseded = false;  // a newer boot of this robot was verified
  bool is_silent = false;      // for too long; heard again, it is a peer as before
  bool is_namesake = false;    // has this robot's own name
  bool has_left = false;       // said BYE; kept so that nothing of it can be repeated
  bool conflict_told = false;

  // Takes part in the exchange.
  bool is_peer() const { return is_newest() && !is_silent; }
  // Would take part if it were heard.
  bool is_newest() const { return !is_superseded && !is_namesake && !has_left; }
};

// A datagram of a verified peer that was not heard before.
struct Fresh {
  int session = 0;
  std::uint64_t counter = 0;
  exchange::Bytes payload;  // inside the buffer that was given; its sections fit
};

class Sessions {
 public:
  explicit Sessions(const SessionSettings& settings);
  Sessions(const Sessions&) = delete;
  Sessions& operator=(const Sessions&) = delete;

  const SenderId& own() const { return own_; }

  // Other keys of the fleet from now on. Whoever is a peer stays one, and is heard when it seals
  // with one of them.
  void set_keys(const FleetKeys& keys);

  // False when there is nothing more to do with it: rejected and counted, or an answer was queued.
  // `payload` has kMaxPayloadBytes.
  bool receive(Time now, const Endpoint& from, exchange::Bytes datagram,
               std::span<std::uint8_t> payload, Fresh& out);

  bool has_answer() const { return !handshake_.empty(); }
  // The next challenge or response that waits, sealed; 0 when there is none.
  std::size_t next_answer(Endpoint& to, std::span<std::uint8_t> datagram);
  // Header and tag around a payload of this robot. `datagram` has kMaxDatagramBytes.
  std::size_t seal(exchange::Bytes payload, std::span<std::uint8_t> datagram);

  // Those who were silent for too long are no peers any more. They stay verified, and are peers
  // again with their next datagram, as long as nobody else needs the room.
  void forget_silent(Time now);

  // nullptr: the slot is free.
  const Session* session(int slot) const {
    const auto s = static_cast<std::size_t>(slot);
    return used_[s] ? &sessions_[s] : nullptr;
  }
  // The slot of the peer, or -1.
  int find_peer(std::uint64_t robot) const;
  // Rises when somebody became a peer or is none any more.
  std::uint64_t changes() const { return changes_; }

  // A fault that shows behind the frame.
  void count_rejected(Rejected reason) { ++counters_.rejected[static_cast<std::size_t>(reason)]; }
  void tell(LinkEventKind kind, const Session& session, int value = 0);
  bool next_event(LinkEvent& out);
  const LinkCounters& counters() const { return counters_; }

 private:
  struct Guard {        // what a session's datagrams are held against
    SecretKey key;      // of the sender
    int fleet_key = 0;  // from which it was derived
    ReplayWindow window;
  };

  bool reject(Rejected reason);
  int fleet_key_of(const KeyHint& hint) const;
  int find(const SenderId& id) const;
  bool unseal(int slot, const FrameHeader& header, exchange::Bytes datagram,
              std::span<std::uint8_t> payload, std::size_t& bytes);
  bool note_version(const FrameHeader& header, const Endpoint& from);
  bool greet(Time now, const Endpoint& from, const FrameHeader& header, exchange::Bytes payload,
             std::size_t datagram_bytes);
  void admit(Time now, const Endpoint& from, const FrameHeader& header);
  int room_for(Time now) const;
  int find_newest(std::uint64_t robot) const;
  bool note_peer(Time now, int slot, const FrameHeader& header, const Endpoint& from,
                 exchange::Bytes payload);
  bool note_double(Session& session, Time now);
  void put_event(const LinkEvent& event);

  std::array<SecretKey, 2> fleet_keys_;
  std::array<KeyHint, 2> hints_;
  std::size_t key_count_ = 1;
  SenderId own_;
  RobotName name_;
  SecretKey own_key_;
  std::uint64_t counter_ = 0;
  Duration forget_after_;
  Handshake handshake_;

  std::array<bool, kMaxSessions> used_ = {};
  std::array<SenderId, kMaxSessions> ids_;  // of used slots, side by side for the search
  std::array<Session, kMaxSessions> sessions_;
  std::array<Guard, kMaxSessions> guards_;
  FixedVector<std::uint64_t, 16> told_versions_;  // boots that speak others

  std::uint64_t changes_ = 0;
  LinkCounters counters_;
  std::array<LinkEvent, 32> events_;  // a ring
  std::size_t first_event_ = 0;
  std::size_t waiting_events_ = 0;
};

}  // namespace zenith
