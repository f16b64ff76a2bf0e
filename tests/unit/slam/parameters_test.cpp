#include "slam/parameters.h"

#include <algorithm>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace zenith {
namespace {

// Converts to anything: with so many of them an aggregate of so many fields can be made.
struct Anything {
  template <typename T>
  operator T() const;  // NOLINT(google-explicit-constructor)
};

template <typename T, std::size_t... I>
constexpr bool takes(std::index_sequence<I...>) {
  return requires {
    T{(static_cast<void>(I), Anything{})...};
  };
}

template <typename T, std::size_t N = 0>
constexpr std::size_t field_count() {
  if constexpr (takes<T>(std::make_index_sequence<N + 1>{})) {
    return field_count<T, N + 1>();
  } else {
    return N;
  }
}

std::ptrdiff_t offset_of(const ParameterInfo& info, const Parameters& p) {
  const auto* base = reinterpret_cast<const char*>(&p);
  return std::visit([&](auto field) { return reinterpret_cast<const char*>(&(p.*field)) - base; },
                    info.field);
}

TEST(Parameters, TableHasEachFieldOnce) {
  const Parameters p;
  std::set<std::ptrdiff_t> offsets;
  for (const ParameterInfo& info : parameter_table()) {
    EXPECT_TRUE(offsets.insert(offset_of(info, p)).second) << info.key << " is there twice";
  }
  EXPECT_EQ(parameter_table().size(), field_count<Parameters>());
}

TEST(Parameters, KeysAreUniqueAndPlain) {
  std::set<std::string_view> keys;
  for (const ParameterInfo& info : parameter_table()) {
    EXPECT_TRUE(keys.insert(info.key).second) << info.key;
    EXPECT_FALSE(info.text.empty()) << info.key;
    EXPECT_TRUE(std::all_of(info.key.begin(), info.key.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    })) << info.key;
  }
}

TEST(Parameters, DefaultsLieInTheirRanges) {
  const Parameters p;
  for (const ParameterInfo& info : parameter_table()) {
    const double value =
        std::visit([&p](auto field) { return static_cast<double>(p.*field); }, info.field);
    EXPECT_LT(info.min, info.max) << info.key;
    EXPECT_TRUE(info.allows(value)) << info.key;
  }
}

// The core takes no parameter beyond its range, whoever gives it.
TEST(Parameters, BeyondTheirRangeTheyStopAtItsEnd) {
  int limited = -1;
  const Parameters same = within_limits(Parameters{}, &limited);
  EXPECT_EQ(limited, 0);
  EXPECT_EQ(same.particles, Parameters{}.particles);
  Parameters p;
  p.particles = -3;
  p.corners_max = 1'000'000;
  p.gate_sigma = std::numeric_limits<double>::quiet_NaN();
  p.max_height_m = std::numeric_limits<double>::infinity();
  p.loop_drift = 1e300;
  const Parameters kept = within_limits(p, &limited);
  EXPECT_EQ(limited, 5);
  EXPECT_EQ(kept.particles, 1);
  EXPECT_EQ(kept.corners_max, 128);
  EXPECT_EQ(kept.gate_sigma, Parameters{}.gate_sigma);
  EXPECT_EQ(kept.max_height_m, 100.0);
  EXPECT_EQ(kept.loop_drift, 0.1);
}

// A table's row names the field that its key names: the rows follow the struct's order.
TEST(Parameters, RowsFollowTheStruct) {
  const Parameters p;
  std::ptrdiff_t last = -1;
  for (const ParameterInfo& info : parameter_table()) {
    EXPECT_GT(offset_of(info, p), last) << info.key;
    last = offset_of(info, p);
  }
}

}  // namespace
}  // namespace zenith
