#pragma once
// The exchange with other robots as one object: datagrams in, datagrams out.
//
//   receive: frame and tag -> who is it (sessions.h) -> contents (slam/exchange/synchroniser.h)
//   next:    challenges and responses -> what the synchroniser says -> sealed
//
// Sans-I/O: time, datagrams and randomness are arguments. One thread at a time; all memory is taken
// at construction.

#include <array>
#include <span>

#include "platform/base/memory_block.h"
#include "platform/link/sessions.h"
#include "slam/exchange/synchroniser.h"

namespace zenith {

struct PeerExchangeSettings {
  SessionSettings sessions;
  // Its robot and name come from `sessions`.
  exchange::Settings synchroniser;
};

// Where a datagram is to go.
struct Dispatch {
  bool to_everybody = false;  // else to `to`
  Endpoint to;
  std::size_t size = 0;  // 0: nothing is due
};

class PeerExchange {
 public:
  explicit PeerExchange(const PeerExchangeSettings& settings);

  // Peers' records and what becomes of their maps goes to `sink`.
  void receive(Time now, const Endpoint& from, exchange::Bytes datagram,
               exchange::RecordSink& sink);
  // The next datagram that is due, into `out` (kMaxDatagramBytes): to be called until there is
  // none.
  Dispatch next(Time now, std::span<std::uint8_t> out);
  // When next() will have something, if nothing else is called before; never before `now`.
  Time next_time(Time now) const;
  // Once a second.
  void forget_silent(Time now);

  // The own map and state; peers' states. Not its join(), leave(), receive() and next().
  exchange::Synchroniser& synchroniser() { return synchroniser_; }
  const exchange::Synchroniser& synchroniser() const { return synchroniser_; }
  // What one takes, itself and all that its constructor takes.
  static MemoryTable memory_table();
  Sessions& sessions() { return sessions_; }
  const Sessions& sessions() const { return sessions_; }

 private:
  void reconcile(Time now);
  void note_verdict(Time now, int session, exchange::Verdict verdict);

  Sessions sessions_;
  MemoryBlock memory_;
  exchange::Synchroniser synchroniser_;
  std::array<exchange::Sender, kMaxSessions> joined_ = {};  // as the synchroniser knows them
  std::uint64_t changes_seen_ = 0;
  std::uint64_t quarantines_seen_ = 0;
};

}  // namespace zenith
