#include "platform/link/handshake.h"

#include <sodium.h>

#include <algorithm>
#include <cassert>

namespace zenith {

bool Handshake::Bucket::take(Time now) {
  tokens = std::min(tokens + (now - filled).seconds() * kPerSecond, double{kBurst});
  filled = now;
  if (tokens < 1.0) return false;
  tokens -= 1.0;
  return true;
}

Handshake::Nonce Handshake::nonce_of(const SenderId& sender, std::int64_t step) const {
  std::array<std::uint8_t, 24> what;
  exchange::ByteWriter writer(what);
  writer.u64(sender.robot);
  writer.u64(sender.boot);
  writer.u64(static_cast<std::uint64_t>(step));
  assert(writer.left() == 0);
  Nonce nonce;
  crypto_generichash(nonce.data(), nonce.size(), what.data(), what.size(), secret_.bytes().data(),
                     SecretKey::kBytes);
  return nonce;
}

bool Handshake::challenged_lately(Time now, const SenderId& sender) const {
  return std::any_of(lately_.begin(), lately_.end(), [&](const Challenged& c) {
    return c.used && c.sender == sender && now < c.at + kAgain;
  });
}

bool Handshake::challenge(Time now, const SenderId& sender, const Endpoint& from,
                          std::size_t heard_bytes) {
  if (heard_bytes < kAnswerBytes || waiting_ == answers_.size()) return false;
  if (challenged_lately(now, sender) || !challenges_.take(now)) return false;
  lately_[next_lately_] = {sender, now, true};
  next_lately_ = (next_lately_ + 1) % lately_.size();
  return put({Answer::Kind::kChallenge,
              from,
              {sender.robot, sender.boot, nonce_of(sender, now.ns / kNonceStep.ns)}});
}

bool Handshake::respond(Time now, const SenderId& sender, const Endpoint& from,
                        const exchange::Challenge& challenge) {
  if (waiting_ == answers_.size() || !responses_.take(now)) return false;
  return put({Answer::Kind::kResponse, from, {sender.robot, sender.boot, challenge.nonce}});
}

bool Handshake::is_answered(Time now, const SenderId& sender, const Nonce& nonce) const {
  const std::int64_t step = now.ns / kNonceStep.ns;
  const auto is = [&](std::int64_t at) {
    const Nonce expected = nonce_of(sender, at);
    return sodium_memcmp(expected.data(), nonce.data(), nonce.size()) == 0;
  };
  return is(step) || is(step - 1);
}

bool Handshake::put(const Answer& answer) {
  assert(waiting_ < answers_.size());
  answers_[(first_ + waiting_) % answers_.size()] = answer;
  ++waiting_;
  return true;
}

bool Handshake::next(Answer& out) {
  if (waiting_ == 0) return false;
  out = answers_[first_];
  first_ = (first_ + 1) % answers_.size();
  --waiting_;
  return true;
}

}  // namespace zenith
