#pragma once
// Findings with hysteresis: a reason is given when its finding has held for a while, and withdrawn
// when the contrary has. What has happened on the way stays.

#include <array>

#include "slam/watch/verdict.h"

namespace zenith {

class Reasons {
 public:
  static constexpr Duration kRaiseAfter = {1'500'000'000};
  static constexpr Duration kWithdrawAfter = {4'000'000'000};
  static constexpr Duration kActiveFor = {10'000'000'000};

  // The finding holds at `now`, or does not.
  void set(SetupCode code, bool holds, VerdictState severity, double value, Time now);
  // Nothing can be said of it: as it was.
  void keep(SetupCode code, Time now);
  // It has happened: at once, and for good. The largest value counts.
  void happened(SetupCode code, double value, Time now);

  bool given(SetupCode code) const { return of(code).given; }
  // `first`: since_s counts from there. Without enough to judge by, that is a reason as well.
  SetupVerdict verdict(Time first, Time now, bool judged) const;

 private:
  struct Finding {
    bool given = false;
    bool event = false;
    bool pending = false;  // the contrary of `given` holds since `changed`
    VerdictState severity = VerdictState::kDoubtful;
    double value = 0.0;
    Time since;
    Time changed;
    Time last;
  };
  const Finding& of(SetupCode code) const { return findings_[static_cast<std::size_t>(code)]; }
  Finding& of(SetupCode code) { return findings_[static_cast<std::size_t>(code)]; }

  std::array<Finding, kSetupCodes> findings_ = {};
};

}  // namespace zenith
