// Reasons come and go with hysteresis, and each has a name and a line with advice.

#include "slam/watch/verdict.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "slam/watch/reasons.h"

namespace zenith {
namespace {

Time at(double seconds) {
  return Time{} + Duration::from_seconds(seconds);
}

TEST(Reasons, HoldForAWhileBeforeTheyAreGiven) {
  Reasons reasons;
  const auto holds = [&](bool yes, double s) {
    reasons.set(SetupCode::kYawWrong, yes, VerdictState::kWrong, 12.0, at(s));
    return reasons.given(SetupCode::kYawWrong);
  };
  EXPECT_FALSE(holds(true, 1.0));
  EXPECT_FALSE(holds(false, 2.0));
  EXPECT_FALSE(holds(true, 3.0));
  EXPECT_FALSE(holds(true, 4.0));
  EXPECT_TRUE(holds(true, 4.6));
  // A single contrary finding changes nothing; one that lasts does.
  EXPECT_TRUE(holds(false, 5.0));
  EXPECT_TRUE(holds(true, 6.0));
  EXPECT_TRUE(holds(false, 7.0));
  EXPECT_FALSE(holds(false, 11.1));
}

TEST(Reasons, TheGravestComesFirstAndDecides) {
  Reasons reasons;
  reasons.happened(SetupCode::kWheelsSlipped, 9.0, at(2.0));
  for (const double s : {3.0, 5.0}) {
    reasons.set(SetupCode::kWheelsSwapped, true, VerdictState::kWrong, 0.0, at(s));
  }
  const SetupVerdict verdict = reasons.verdict(at(1.0), at(5.0), true);
  EXPECT_EQ(verdict.state, VerdictState::kWrong);
  ASSERT_EQ(verdict.reasons.size(), 2U);
  EXPECT_EQ(verdict.reasons[0].code, SetupCode::kWheelsSwapped);
  EXPECT_DOUBLE_EQ(verdict.reasons[0].since_s, 2.0);
  EXPECT_EQ(verdict.reasons[1].code, SetupCode::kWheelsSlipped);
}

TEST(Reasons, WhatHasHappenedStaysButIsNotActiveForEver) {
  Reasons reasons;
  reasons.happened(SetupCode::kViewJumped, 1.0, at(2.0));
  EXPECT_TRUE(reasons.verdict(at(0.0), at(3.0), true).reasons[0].active);
  const SetupVerdict later = reasons.verdict(at(0.0), at(100.0), true);
  EXPECT_EQ(later.state, VerdictState::kDoubtful);
  ASSERT_EQ(later.reasons.size(), 1U);
  EXPECT_FALSE(later.reasons[0].active);
}

TEST(Reasons, UnjudgedIsDoubtful) {
  const Reasons none;
  EXPECT_EQ(none.verdict(at(0.0), at(1.0), true).state, VerdictState::kGood);
  const SetupVerdict unjudged = none.verdict(at(0.0), at(1.0), false);
  EXPECT_EQ(unjudged.state, VerdictState::kDoubtful);
  EXPECT_EQ(unjudged.reasons[0].code, SetupCode::kNotJudgedYet);
}

TEST(SetupVerdict, EachCodeHasANameAndAdvice) {
  std::set<std::string> names;
  for (int i = 0; i < kSetupCodes; ++i) {
    Reason reason;
    reason.code = static_cast<SetupCode>(i);
    reason.value = -12345.678;
    const std::string text(reason_text(reason).view());
    EXPECT_GT(text.size(), 40U) << i;
    EXPECT_LT(text.size(), 320U) << "cut: " << text;
    EXPECT_TRUE(text.find(':') != std::string::npos || text.find(';') != std::string::npos) << text;
    names.insert(std::string(setup_code_name(reason.code)));
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(kSetupCodes));
}

}  // namespace
}  // namespace zenith
