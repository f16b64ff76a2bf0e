#pragma once
// Keeps the own map and those of the peers in step (docs/protocol.md, "Keeping in step").
//
// Sans-I/O: payloads go in and out, time is an argument. Whoever calls verifies, seals and sends;
// he gives each verified (robot, boot) a session, an index below kMaxSessions. HELLO, CHALLENGE and
// RESPONSE are his, except that HELLO is sent from here, beside STATE.
// One thread at a time. No heap: all memory comes from the arena.

#include <span>

#include "platform/base/arena.h"
#include "slam/exchange/interface.h"

namespace zenith::exchange {

class Synchroniser {
 public:
  void layout(Arena& arena);
  // After layout over a real block. All begins anew.
  void configure(const Settings& settings);

  // --- The own robot.
  // The landmark's newest state. False when it cannot be told (encode_record) or finds no room.
  bool set_own(const LandmarkRecord& record);
  // The map begins anew, empty, under a new random number.
  void reset_own(std::uint32_t new_map);
  void set_state(const Pose2& T_start_robot, Health health,
                 std::span<const OwnAlignment> alignments);
  // Datagrams that go out when everybody is told: 1 with multicast, else the number of addresses.
  void set_copies_to_everybody(int copies);
  // The next datagram tells all that the program ends.
  void say_bye();

  // --- Verified peers.
  void join(Time now, int session, const Sender& sender);
  // It seals with another key of the fleet from now on.
  void change_key(int session, std::uint16_t key);
  void leave(Time now, int session);
  // A whole payload; `counter` is the datagram's and tells older from newer states.
  Verdict receive(Time now, int session, std::uint64_t counter, Bytes payload, RecordSink& sink);
  // A fault that the caller noticed.
  void fault(Time now, int session, RecordSink& sink);
  bool quarantined(Time now, int session) const;

  // --- Sending.
  // What is due, into `out` (kMaxPayload bytes): to be called until it says that nothing is. What
  // was handed out counts as sent.
  Outgoing next(Time now, std::span<std::uint8_t> out);
  // When next() will have something, if nothing else is called before; never before `now`.
  Time next_time(Time now) const;
  // Takes a datagram of the caller's own, with so many bytes of payload, from the same budget.
  // False: it must not be sent now.
  bool spend(Time now, std::size_t payload_bytes);
  // When it may.
  Time when_spent(Time now, std::size_t payload_bytes) const;

  // --- Reading.
  const PeerStatus& peer(int slot) const;  // slot below kMaxReplicas
  int slot_of(int session) const;          // -1: none
  const Counters& counters() const;

 private:
  struct State;
  State* state_ = nullptr;  // in the arena
};

}  // namespace zenith::exchange
