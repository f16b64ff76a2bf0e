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
  int answers_per_second = Handshake::kPerSecond;  // of each kind, to senders not verified
};

struct Session {
  SenderId id;
  KeyHint key = {};      // of its newest datagram
  RobotName name;        // empty until its HELLO came
  Endpoint address;      // where it is reached
  Endpoint moved_to;     // another one that it was heard from, and challenged at
  bool reached = false;  // it answered at `address`; until then only challenges may go there
  Time verified;
  Time heard;
  Time heard_at_address;
  Time unheard_since;          // it is not listened to
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
  KeyHint key = {};         // with which it was sealed
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
  // This peer is not to be believed. When another sender with its robot's name still talks, which
  // had to give way to it, that one is the peer from now on.
  void set_aside(Time now, int slot);

  // A fault that shows behind the frame.
  void count_rejected(Rejected reason) { ++counters_.rejected[static_cast<std::size_t>(reason)]; }
  void tell(LinkEventKind kind, const Session& session, int value = 0);
  bool next_event(LinkEvent& out);
  const LinkCounters& counters() const { return counters_; }

 private:
  struct Guard {  // what a session's datagrams are held against
    SecretKey key;
    KeyHint hint = {};  // of the fleet's key from which it was derived
    ReplayWindow window;
  };
  // One datagram whose tag was right.
  struct Opened {
    Time now;
    Endpoint from;
    FrameHeader header;
    SenderId sender;  // as it is, not as the header shows it
    exchange::Bytes payload;
    std::size_t datagram_bytes = 0;
  };

  bool reject(Rejected reason);
  const SecretKey* fleet_key_of(const KeyHint& hint) const;
  int find(const std::array<SenderId, kMaxSessions>& ids, const SenderId& id) const;
  void set_key(int slot, const KeyHint& hint, const SecretKey& fleet_key);
  bool note_version(const Opened& opened);
  bool greet(const Opened& opened);
  bool challenge(const Opened& opened, Handshake::Asked asked);
  void respond(const Opened& opened, const exchange::Challenge& challenge);
  void admit(const Opened& opened, const Handshake::Nonce& nonce);
  int room_for(Time now, std::uint64_t robot) const;
  int find_newest(std::uint64_t robot) const;
  bool note_peer(int slot, const Opened& opened);
  bool note_address(Session& session, const Opened& opened);
  void note_response(Session& session, const Opened& opened, const Handshake::Nonce& nonce);
  bool note_double(Session& session, Time now);
  bool is_for_us(const std::optional<exchange::Challenge>& challenge) const;
  void put_event(const LinkEvent& event);

  std::array<SecretKey, 2> fleet_keys_;
  std::array<KeyHint, 2> hints_;
  std::size_t key_count_ = 1;
  SenderId own_;
  SenderId own_shown_;  // as its datagrams show it
  RobotName name_;
  SecretKey own_key_;
  std::uint64_t counter_ = 0;
  Duration forget_after_;
  Handshake handshake_;

  std::array<bool, kMaxSessions> used_ = {};
  std::array<SenderId, kMaxSessions> ids_;    // of used slots, side by side for the search
  std::array<SenderId, kMaxSessions> shown_;  // the same, as the headers show them
  std::array<Session, kMaxSessions> sessions_;
  std::array<Guard, kMaxSessions> guards_;
  std::array<std::uint64_t, 16> told_versions_ = {};  // boots that speak others, a ring
  std::size_t next_told_version_ = 0;
  Time version_told_;
  Time no_room_told_;

  std::uint64_t changes_ = 0;
  LinkCounters counters_;
  std::array<LinkEvent, 32> events_;  // a ring
  std::size_t first_event_ = 0;
  std::size_t waiting_events_ = 0;
};

}  // namespace zenith
