#include "slam/watch/reasons.h"

#include <algorithm>
#include <cmath>

namespace zenith {

void Reasons::set(SetupCode code, bool holds, VerdictState severity, double value, Time now) {
  Finding& f = of(code);
  if (f.given && holds) {
    f.severity = severity;
    f.value = value;
    f.last = now;
  }
  if (f.given == holds) {
    f.pending = false;
    return;
  }
  if (!f.pending) {
    f.pending = true;
    f.changed = now;
    return;
  }
  if (now - f.changed < (holds ? kRaiseAfter : kWithdrawAfter)) return;
  f.pending = false;
  f.given = holds;
  f.since = f.changed;
  f.last = now;
  f.severity = severity;
  f.value = value;
}

void Reasons::keep(SetupCode code, Time now) {
  Finding& f = of(code);
  f.pending = false;
  if (f.given) f.last = now;
}

void Reasons::happened(SetupCode code, double value, Time now) {
  Finding& f = of(code);
  if (!f.given) f.since = now;
  f.value = f.given && std::abs(f.value) > std::abs(value) ? f.value : value;
  f.given = true;
  f.event = true;
  f.severity = VerdictState::kDoubtful;
  f.last = now;
}

SetupVerdict Reasons::verdict(Time first, Time now, bool judged) const {
  SetupVerdict out;
  out.state = VerdictState::kGood;
  for (int i = 0; i < kSetupCodes; ++i) {
    const auto code = static_cast<SetupCode>(i);
    const Finding& f = of(code);
    if (!f.given) continue;
    const bool active = !f.event || now - f.last < kActiveFor;
    out.reasons.push_back({code, f.severity, f.value, (f.since - first).seconds(), active});
  }
  std::sort(out.reasons.begin(), out.reasons.end(), [](const Reason& a, const Reason& b) {
    if (a.severity != b.severity) return a.severity > b.severity;
    return a.since_s != b.since_s ? a.since_s < b.since_s : a.code < b.code;
  });
  if (!judged && out.reasons.empty()) {
    out.reasons.push_back({SetupCode::kNotJudgedYet, VerdictState::kDoubtful, 0.0, 0.0, true});
  }
  for (const Reason& r : out.reasons) out.state = std::max(out.state, r.severity);
  return out;
}

}  // namespace zenith
