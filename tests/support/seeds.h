#pragma once
// The seed of a random test: the same in every run unless ZENITH_TEST_SEED says otherwise, and
// printed with every failure of the test that holds it.
//
//   const TestSeed seed;
//   Random random(seed.value());

#include <cstdint>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

namespace zenith {

class TestSeed {
 public:
  // The fallback is the test's own default; file and line are the caller's.
  explicit TestSeed(std::uint64_t fallback = 20090701, const char* file = __builtin_FILE(),
                    int line = __builtin_LINE())
      : value_(from_environment(fallback)),
        trace_(file, line, "repeat with ZENITH_TEST_SEED=" + std::to_string(value_)) {}

  std::uint64_t value() const { return value_; }

 private:
  static std::uint64_t from_environment(std::uint64_t fallback) {
    const char* text = std::getenv("ZENITH_TEST_SEED");
    return text == nullptr || *text == '\0' ? fallback : std::strtoull(text, nullptr, 10);
  }

  std::uint64_t value_;
  ::testing::ScopedTrace trace_;
};

}  // namespace zenith
