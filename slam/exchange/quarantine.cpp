#include "slam/exchange/quarantine.h"

#include <algorithm>
#include <tuple>

namespace zenith::exchange {
namespace {

constexpr Duration kWindow = Duration::from_seconds(60.0);
constexpr Duration kFirst = Duration::from_seconds(60.0);
constexpr Duration kLongest = Duration::from_seconds(3600.0);
constexpr Duration kForgiven = Duration::from_seconds(3600.0);

}  // namespace

const Quarantine::Offender* Quarantine::find(const Sender& sender) const {
  for (const Offender& o : offenders_) {
    if (o.used && o.sender == sender) return &o;
  }
  return nullptr;
}

Quarantine::Offender& Quarantine::entry_of(Time now, const Sender& sender) {
  for (Offender& o : offenders_) {
    if (o.used && o.sender == sender) return o;
  }
  Offender& o = *std::min_element(offenders_.begin(), offenders_.end(),
                                  [now](const Offender& a, const Offender& b) {
                                    return std::tuple(a.used, a.until > now, a.last.ns) <
                                           std::tuple(b.used, b.until > now, b.last.ns);
                                  });
  o = Offender{};
  o.used = true;
  o.sender = sender;
  return o;
}

bool Quarantine::fault(Time now, const Sender& sender) {
  Offender& o = entry_of(now, sender);
  if (now < o.until) return false;
  if (o.length > Duration{} && now - o.last > kForgiven) o.length = {};
  o.last = now;
  o.faults[o.count % kFaults] = now;
  ++o.count;
  const Time first_of_three = o.faults[o.count % kFaults];
  if (o.count < kFaults || now - first_of_three > kWindow) return false;
  o.length = o.length > Duration{} ? std::min(o.length + o.length, kLongest) : kFirst;
  o.until = now + o.length;
  o.last = o.until;
  o.count = 0;
  return true;
}

bool Quarantine::holds(Time now, const Sender& sender) const {
  const Offender* o = find(sender);
  return o != nullptr && now < o->until;
}

}  // namespace zenith::exchange
