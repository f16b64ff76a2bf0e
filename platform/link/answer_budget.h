#pragma once
// How many answers to senders that are not known yet may go out: so many a second to each source,
// and so many in all. Whoever plays recorded datagrams from one address uses up the share of that
// address alone.
//
// A source is an IPv4 address, a link-local IPv6 address, or the 64-bit prefix of another IPv6
// address; never the port, which costs nothing to change. Sources are told apart by a keyed hash
// that changes every few seconds, so nobody can choose to share another one's place. Fixed size.

#include <array>
#include <cstddef>
#include <cstdint>

#include "platform/base/endpoint.h"
#include "platform/base/time.h"
#include "platform/link/fleet_key.h"

namespace zenith {

class AnswerBudget {
 public:
  static constexpr int kPerSourceAndSecond = 8;
  static constexpr int kSourceBurst = 16;
  static constexpr std::size_t kMaxBurst = 64;  // in all
  static constexpr std::size_t kPlaces = 256;

  // `per_second` in all; at once as many, at most kMaxBurst.
  AnswerBudget(const SecretKey& secret, int per_second)
      : secret_(secret), per_second_(per_second), all_{burst(), {}} {
    places_.fill({double{kSourceBurst}, {}});
  }

  // False: none may go to `to` at `now`.
  bool take(Time now, const Endpoint& to);

 private:
  struct Bucket {
    double tokens = 0.0;
    Time filled;
    void fill(Time now, double per_second, double most);
  };
  double burst() const;
  std::size_t place_of(Time now, const Endpoint& to) const;

  SecretKey secret_;
  int per_second_;
  Bucket all_;
  std::array<Bucket, kPlaces> places_;
};

}  // namespace zenith
