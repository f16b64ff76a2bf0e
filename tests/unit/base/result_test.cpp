#include "platform/base/result.h"

#include <memory>
#include <string>

#include <gtest/gtest.h>

namespace zenith {
namespace {

Result<int> half(int n) {
  if (n % 2 != 0) return Error{"expected an even number, found " + std::to_string(n)};
  return n / 2;
}

Status check(bool good) {
  if (!good) return Error{"bad"};
  return {};
}

TEST(Result, HoldsAValue) {
  const Result<int> r = half(8);
  ASSERT_TRUE(r.ok());
  EXPECT_TRUE(r);
  EXPECT_EQ(*r, 4);
  EXPECT_EQ(r.value(), 4);
}

TEST(Result, HoldsAnError) {
  const Result<int> r = half(7);
  ASSERT_FALSE(r.ok());
  EXPECT_FALSE(r);
  EXPECT_EQ(r.error().message, "expected an even number, found 7");
}

TEST(Result, GivesAccessToMembersAndLetsThemChange) {
  Result<std::string> r = std::string("abc");
  EXPECT_EQ(r->size(), 3u);
  *r += "d";
  EXPECT_EQ(r.value(), "abcd");
}

TEST(Result, CarriesWhatCanOnlyBeMoved) {
  Result<std::unique_ptr<int>> r = std::make_unique<int>(5);
  ASSERT_TRUE(r.ok());
  const std::unique_ptr<int> taken = std::move(r.value());
  EXPECT_EQ(*taken, 5);
}

TEST(Status, IsSuccessUnlessItHoldsAnError) {
  EXPECT_TRUE(check(true).ok());
  const Status bad = check(false);
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().message, "bad");
}

TEST(ResultDeathTest, ReadingTheWrongOneEndsTheProgramInEveryBuild) {
  EXPECT_DEATH(static_cast<void>(half(7).value()), "value of an error");
  EXPECT_DEATH(static_cast<void>(half(8).error()), "error of a success");
  EXPECT_DEATH(static_cast<void>(check(true).error()), "error of a success");
}

}  // namespace
}  // namespace zenith
