#pragma once
// Who is believed (docs/protocol.md): challenges that need no memory of whom they were sent to, and
// the answers that wait to be sent, few enough that nobody can make this robot shout at others.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "platform/base/endpoint.h"
#include "platform/base/time.h"
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

  static constexpr std::size_t kBurst = 16;  // answers at once, challenges and responses each
  static constexpr int kPerSecond = 8;       // and from then on
  // The same robot is challenged again after this at the earliest: its next HELLO.
  static constexpr Duration kAgain = {1'900'000'000};
  static constexpr Duration kNonceStep = {5'000'000'000};

  // `secret` is random, new at each start of the program.
  explicit Handshake(const SecretKey& secret) : secret_(secret) {}

  // An unverified sender was heard, in a datagram of so many bytes. False: not challenged.
  bool challenge(Time now, const SenderId& sender, const Endpoint& from, std::size_t heard_bytes);
  // A challenge for this robot came from `sender`.
  bool respond(Time now, const SenderId& sender, const Endpoint& from,
               const exchange::Challenge& challenge);
  // Whether the nonce is one that `sender` was sent in this or the last step of time.
  bool is_answered(Time now, const SenderId& sender, const Nonce& nonce) const;

  // The next answer that waits; false when there is none.
  bool next(Answer& out);
  bool empty() const { return waiting_ == 0; }

 private:
  // Lets kPerSecond through, and kBurst at once.
  struct Bucket {
    double tokens = kBurst;
    Time filled;
    bool take(Time now);
  };
  struct Challenged {
    SenderId sender;
    Time at;
    bool used = false;
  };

  Nonce nonce_of(const SenderId& sender, std::int64_t step) const;
  bool challenged_lately(Time now, const SenderId& sender) const;
  bool put(const Answer& answer);

  SecretKey secret_;
  Bucket challenges_;
  Bucket responses_;
  std::array<Challenged, 32> lately_;  // a ring
  std::size_t next_lately_ = 0;
  std::array<Answer, 2 * kBurst> answers_;  // a ring
  std::size_t first_ = 0;
  std::size_t waiting_ = 0;
};

}  // namespace zenith
