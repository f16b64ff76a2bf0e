#include "platform/link/answer_budget.h"

#include <sodium.h>

#include <algorithm>
#include <cassert>

#include "slam/exchange/bytes.h"

namespace zenith {
namespace {

// Sources that share a place by chance do not share the next one.
constexpr Duration kPlacesHold = {5'000'000'000};
constexpr std::size_t kPrefixBytes = 8;

bool is_link_local(const Endpoint& e) {
  return e.is_ipv6 && e.address[0] == 0xFE && (e.address[1] & 0xC0) == 0x80;
}

}  // namespace

void AnswerBudget::Bucket::fill(Time now, double per_second, double most) {
  tokens = std::min(tokens + (now - filled).seconds() * per_second, most);
  filled = now;
}

double AnswerBudget::burst() const {
  return std::clamp(static_cast<double>(per_second_), 1.0, double{kMaxBurst});
}

std::size_t AnswerBudget::place_of(Time now, const Endpoint& to) const {
  static_assert(SecretKey::kBytes >= crypto_shorthash_KEYBYTES);
  Endpoint source = to;
  if (to.is_ipv6 && !is_link_local(to)) {
    std::fill(source.address.begin() + kPrefixBytes, source.address.end(), std::uint8_t{0});
  }
  std::array<std::uint8_t, 29> what;
  exchange::ByteWriter writer(what);
  writer.u8(to.is_ipv6 ? 1 : 0);
  writer.bytes(source.address);
  writer.u32(to.interface);
  writer.u64(static_cast<std::uint64_t>(now.ns / kPlacesHold.ns));
  assert(writer.left() == 0);
  std::array<std::uint8_t, crypto_shorthash_BYTES> hash;
  crypto_shorthash(hash.data(), what.data(), what.size(), secret_.bytes().data());
  return exchange::ByteReader(hash).u64() % kPlaces;
}

bool AnswerBudget::take(Time now, const Endpoint& to) {
  Bucket& place = places_[place_of(now, to)];
  place.fill(now, kPerSourceAndSecond, kSourceBurst);
  all_.fill(now, per_second_, burst());
  if (place.tokens < 1.0 || all_.tokens < 1.0) return false;
  place.tokens -= 1.0;
  all_.tokens -= 1.0;
  return true;
}

}  // namespace zenith
