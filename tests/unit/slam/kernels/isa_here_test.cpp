// Emulated processors lack instruction sets on purpose: the run says which one must be found there.
#include <cstdlib>

#include <gtest/gtest.h>

#include "platform/linux/cpu.h"
#include "slam/kernels/isa_in_use.h"

namespace zenith {
namespace {

TEST(IsaHere, IsTheExpectedOne) {
  const char* expected = std::getenv("ZENITH_TEST_ISA");
  if (expected == nullptr) GTEST_SKIP() << "ZENITH_TEST_ISA names no instruction set";
  EXPECT_EQ(isa_name(best_isa()), std::string(expected));
  EXPECT_EQ(isa_in_use(), best_isa()) << "kernels use " << isa_name(isa_in_use());
}

}  // namespace
}  // namespace zenith
