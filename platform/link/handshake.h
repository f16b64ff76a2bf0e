#pragma once
// Who is believed, and where a robot is reached (docs/protocol.md): challenges that need no memory
// of whom they were sent to, and the answers that wait to be sent, few enough that nobody can make
// this robot shout at others.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "platform/base/endpoint.h"
#include "platform/base/time.h"
#include "platform/link/answer_budget.h"
#include "platform/link/sealing.h"
#include "slam/exchange/messages.h"

namespace zenith {

// An answer to one robot. Never longer than what it answers.
struct Answer {
  enum class Kind : std::uint8_t { kChallenge, kResponse };
  Kind kind = Kind::kChallenge;
  Endpoint to;
  exchange::Challenge proof;
};

inline constexpr std::size_t kAnswerPayloadBytes = 35;
inline constexpr std::size_t kAnswerBytes = kHeaderBytes + kAnswerPayloadBytes + kTagBytes;

class Handshake {
 public:
  using Nonce = decltype(exchange::Challenge::nonce);

  // What a challenge asks an answer for.
  enum class Asked : std::uint8_t {
    kJoin,  // the sender is not verified
    kMove,  // a verified one was heard from another address
  };

  static constexpr int kPerSecond = 64;  // answers of each kind, unless told otherwise
  // The same robot is challenged again at the same address after this at the earliest: its next
  // HELLO.
  static constexpr Duration kAgain = {1'900'000'000};
  static constexpr Duration kNonceStep = {5'000'000'000};
  // The longest that a nonce holds.
  static constexpr Duration kNonceHolds = {2 * kNonceStep.ns};

  // `secret` is random, new at each start of the program.
  explicit Handshake(const SecretKey& secret, int per_second = kPerSecond);

  // `sender` was heard from `from`, in a datagram of so many bytes. False: not challenged.
  bool challenge(Time now, Asked asked, const SenderId& sender, const Endpoint& from,
                 std::size_t heard_bytes);
  // A challenge for this robot came from `sender`.
  bool respond(Time now, const SenderId& sender, const Endpoint& from,
               const exchange::Challenge& challenge);
  // Whether the nonce was sent to `sender`, wherever it was then, for it to join, in this or the
  // last step of time.
  bool joins(Time now, const SenderId& sender, const Nonce& nonce) const;
  // Whether it was sent to `sender` at this very address, for whatever reason.
  bool reaches(Time now, const SenderId& sender, const Endpoint& at, const Nonce& nonce) const;

  // The next answer that waits; false when there is none.
  bool next(Answer& out);
  bool empty() const { return waiting_[0].count + waiting_[1].count == 0; }

 private:
  struct Challenged {
    SenderId sender;
    Endpoint at;
    Time when;
    bool used = false;
  };
  struct Ring {
    std::array<Answer, AnswerBudget::kMaxBurst> answers;
    std::size_t first = 0;
    std::size_t count = 0;
    bool full() const { return count == answers.size(); }
    void put(const Answer& answer);
  };
  // Half of a nonce.
  using Half = std::array<std::uint8_t, 8>;

  Half asked_half(Asked asked, const SenderId& sender, std::int64_t step) const;
  Half address_half(const SenderId& sender, const Endpoint& at, std::int64_t step) const;
  Half hash(std::span<const std::uint8_t> what) const;
  bool challenged_lately(Time now, const SenderId& sender, const Endpoint& at) const;

  SecretKey secret_;
  std::array<AnswerBudget, 2> challenges_;  // by what is asked
  AnswerBudget responses_;
  std::array<Challenged, 64> lately_;  // a ring
  std::size_t next_lately_ = 0;
  std::array<Ring, 2> waiting_;  // by kind
};

}  // namespace zenith
