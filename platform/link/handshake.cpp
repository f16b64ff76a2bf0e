#include "platform/link/handshake.h"

#include <sodium.h>

#include <algorithm>
#include <cassert>

#include "platform/base/ensure.h"

namespace zenith {
namespace {

constexpr std::size_t kHalfBytes = 8;

// What the two halves are hashes of begins with one of these.
constexpr std::uint8_t kAddressHalf = 0xA0;
constexpr std::uint8_t kAskedHalf = 0xB0;  // and what is asked

std::size_t index(Answer::Kind kind) {
  return static_cast<std::size_t>(kind);
}

}  // namespace

Handshake::Handshake(const SecretKey& secret, int per_second)
    : secret_(secret),
      challenges_{AnswerBudget(secret, per_second), AnswerBudget(secret, per_second)},
      responses_(secret, per_second) {}

Handshake::Half Handshake::hash(std::span<const std::uint8_t> what) const {
  std::array<std::uint8_t, crypto_generichash_BYTES_MIN> all;
  crypto_generichash(all.data(), all.size(), what.data(), what.size(), secret_.bytes().data(),
                     SecretKey::kBytes);
  Half half;
  std::copy_n(all.begin(), half.size(), half.begin());
  return half;
}

Handshake::Half Handshake::asked_half(Asked asked, const SenderId& sender,
                                      std::int64_t step) const {
  std::array<std::uint8_t, 25> what;
  exchange::ByteWriter writer(what);
  writer.u8(static_cast<std::uint8_t>(kAskedHalf + static_cast<std::uint8_t>(asked)));
  writer.u64(sender.robot);
  writer.u64(sender.boot);
  writer.u64(static_cast<std::uint64_t>(step));
  assert(writer.left() == 0);
  return hash(what);
}

Handshake::Half Handshake::address_half(const SenderId& sender, const Endpoint& at,
                                        std::int64_t step) const {
  std::array<std::uint8_t, 48> what;
  exchange::ByteWriter writer(what);
  writer.u8(kAddressHalf);
  writer.u64(sender.robot);
  writer.u64(sender.boot);
  writer.u8(at.is_ipv6 ? 1 : 0);
  writer.bytes(at.address);
  writer.u32(at.interface);
  writer.u16(at.port);
  writer.u64(static_cast<std::uint64_t>(step));
  assert(writer.left() == 0);
  return hash(what);
}

bool Handshake::challenged_lately(Time now, const SenderId& sender, const Endpoint& at) const {
  return std::any_of(lately_.begin(), lately_.end(), [&](const Challenged& c) {
    return c.used && c.sender == sender && c.at == at && now < c.when + kAgain;
  });
}

bool Handshake::challenge(Time now, Asked asked, const SenderId& sender, const Endpoint& from,
                          std::size_t heard_bytes) {
  Ring& ring = waiting_[index(Answer::Kind::kChallenge)];
  if (heard_bytes < kAnswerBytes || ring.full()) return false;
  if (challenged_lately(now, sender, from)) return false;
  if (!challenges_[static_cast<std::size_t>(asked)].take(now, from)) return false;
  lately_[next_lately_] = {sender, from, now, true};
  next_lately_ = (next_lately_ + 1) % lately_.size();
  const std::int64_t step = now.ns / kNonceStep.ns;
  Answer answer{Answer::Kind::kChallenge, from, {sender.robot, sender.boot, {}}};
  const Half first = asked_half(asked, sender, step);
  const Half second = address_half(sender, from, step);
  std::copy(first.begin(), first.end(), answer.proof.nonce.begin());
  std::copy(second.begin(), second.end(), answer.proof.nonce.begin() + kHalfBytes);
  ring.put(answer);
  return true;
}

bool Handshake::respond(Time now, const SenderId& sender, const Endpoint& from,
                        const exchange::Challenge& challenge) {
  Ring& ring = waiting_[index(Answer::Kind::kResponse)];
  if (ring.full() || !responses_.take(now, from)) return false;
  ring.put({Answer::Kind::kResponse, from, {sender.robot, sender.boot, challenge.nonce}});
  return true;
}

bool Handshake::joins(Time now, const SenderId& sender, const Nonce& nonce) const {
  const std::int64_t step = now.ns / kNonceStep.ns;
  const auto is = [&](std::int64_t at) {
    const Half expected = asked_half(Asked::kJoin, sender, at);
    return sodium_memcmp(expected.data(), nonce.data(), expected.size()) == 0;
  };
  return is(step) || is(step - 1);
}

bool Handshake::reaches(Time now, const SenderId& sender, const Endpoint& at,
                        const Nonce& nonce) const {
  const std::int64_t step = now.ns / kNonceStep.ns;
  const auto is = [&](std::int64_t then) {
    const Half expected = address_half(sender, at, then);
    return sodium_memcmp(expected.data(), nonce.data() + kHalfBytes, expected.size()) == 0;
  };
  return is(step) || is(step - 1);
}

void Handshake::Ring::put(const Answer& answer) {
  ensure(!full(), "Handshake: whether there is room is asked before");
  answers[(first + count) % answers.size()] = answer;
  ++count;
}

// Responses first: who is challenged by a flood of recorded datagrams does not keep this robot from
// being let in by others.
bool Handshake::next(Answer& out) {
  for (const Answer::Kind kind : {Answer::Kind::kResponse, Answer::Kind::kChallenge}) {
    Ring& ring = waiting_[index(kind)];
    if (ring.count == 0) continue;
    out = ring.answers[ring.first];
    ring.first = (ring.first + 1) % ring.answers.size();
    --ring.count;
    return true;
  }
  return false;
}

}  // namespace zenith
