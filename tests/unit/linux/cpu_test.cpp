#include "platform/linux/cpu.h"

#include <gtest/gtest.h>

namespace zenith {
namespace {

TEST(Cpu, HasTheScalarPathAndTheBestOne) {
  EXPECT_TRUE(cpu_has(Isa::kScalar));
  EXPECT_TRUE(cpu_has(best_isa()));
}

TEST(Cpu, WhatLiesBelowItsBestIsThereToo) {
  for (Isa isa = best_isa(); isa != Isa::kScalar; isa = isa_below(isa)) {
    EXPECT_TRUE(cpu_has(isa)) << isa_name(isa);
  }
}

TEST(Cpu, TakesTheBestWhenNothingIsWanted) {
  EXPECT_EQ(*choose_isa(nullptr), best_isa());
  EXPECT_EQ(*choose_isa(""), best_isa());
}

TEST(Cpu, TakesWhatIsWanted) {
  EXPECT_EQ(*choose_isa("scalar"), Isa::kScalar);
  EXPECT_EQ(*choose_isa(std::string(isa_name(best_isa())).c_str()), best_isa());
}

TEST(Cpu, SaysWhatThereIsWhenTheWantedOneIsMissing) {
  const Isa foreign = cpu_has(Isa::kNeon) ? Isa::kAvx2 : Isa::kNeon;
  const auto lacking = choose_isa(std::string(isa_name(foreign)).c_str());
  ASSERT_FALSE(lacking);
  EXPECT_NE(lacking.error().message.find("does not have it; it has scalar"), std::string::npos)
      << lacking.error().message;
  const auto unknown = choose_isa("mmx");
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().message.find("unknown instruction set"), std::string::npos);
}

}  // namespace
}  // namespace zenith
