#include "platform/config/problems.h"

#include <gtest/gtest.h>

namespace zenith {
namespace {

TEST(Problems, AreToldInTheOrderOfTheirLines) {
  Problems problems("some/file");
  EXPECT_FALSE(problems.any());
  problems.add(12, "later");
  problems.add(0, "of the whole");
  problems.add(3, "two\nof them");
  problems.check_range(4, "key", 7.0, 0.0, 5.0);
  problems.check_range(5, "key", 5.0, 0.0, 5.0);
  EXPECT_TRUE(problems.any());
  EXPECT_EQ(problems.error().message,
            "some/file: of the whole\nsome/file:3: two\nsome/file:3: of them\n"
            "some/file:4: key is 7, expected 0 .. 5\nsome/file:12: later");
}

}  // namespace
}  // namespace zenith
