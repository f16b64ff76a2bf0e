// What comes out of the wire is near what went in, never surer than it, and always taken by
// PeerMap.

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "slam/exchange/record_code.h"
#include "slam/geometry.h"
#include "tests/support/seeds.h"
#include "tests/unit/slam/fleet/fleet_world.h"

namespace zenith::exchange {
namespace {

// A covariance with deviations from 0.03 mm to 5 m and correlations up to almost (or just over)
// one.
std::array<float, 6> random_covariance(Random& random) {
  Eigen::Matrix3d factor;
  for (int i = 0; i < 9; ++i) factor(i) = random.normal();
  if (random.below(3) == 0) factor.col(2) = factor.col(0) * random.normal();  // singular
  Eigen::Matrix3d m = factor * factor.transpose();
  Eigen::Vector3d deviations;
  for (int i = 0; i < 3; ++i) deviations(i) = std::exp(random.uniform(-10.4, 1.6));
  const Eigen::Vector3d scale = deviations.cwiseQuotient(m.diagonal().cwiseSqrt());
  m = scale.asDiagonal() * m * scale.asDiagonal();
  std::array<float, 6> c = {};
  int k = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) c[static_cast<std::size_t>(k++)] = static_cast<float>(m(i, j));
  }
  if (random.below(4) == 0) c[1] *= 1.01F;  // no covariance any more
  return c;
}

LandmarkRecord random_record(Random& random) {
  LandmarkRecord r;
  r.id = random.next_u32();
  r.removed = random.below(10) == 0;
  r.observations = static_cast<std::uint16_t>(random.below(600));
  const double reach_m = random.below(2) == 0 ? 30.0 : 8388.0;
  for (float* p : {&r.x_m, &r.y_m, &r.z_m}) {
    *p = static_cast<float>(random.uniform(-reach_m, reach_m));
  }
  r.covariance_m2 = random_covariance(random);
  r.appearance_count = static_cast<std::uint8_t>(random.below(kPublishedAppearances + 1));
  for (std::size_t i = 0; i < r.appearance_count; ++i) {
    r.appearances[i].direction_rad = static_cast<float>(random.uniform(-7.0, 7.0));
    const double peak = random.uniform(0.0, 127.0);
    for (std::int8_t& v : r.appearances[i].descriptor) {
      v = static_cast<std::int8_t>(random.uniform(-peak, peak));
    }
  }
  return r;
}

LandmarkRecord over_the_wire(const LandmarkRecord& r, std::uint32_t first, std::uint16_t above) {
  EncodedRecord encoded;
  EXPECT_TRUE(encode_record(r, encoded));
  std::array<std::uint8_t, kMaxRecordBytes> room = {};
  ByteWriter out(room);
  append_record(out, encoded, above);
  ByteReader in(out.written());
  LandmarkRecord back;
  EXPECT_TRUE(decode_record(in, first, back));
  EXPECT_TRUE(in.done());
  return back;
}

TEST(ExchangeCodeProperty, DecodedRecordsAreNearAndNeverSurer) {
  const TestSeed seed;
  Random random(seed.value());
  point_world::PeerRig rig;
  for (std::uint32_t trial = 0; trial < 4000; ++trial) {
    LandmarkRecord r = random_record(random);
    r.id = trial + 1;
    const auto above = static_cast<std::uint16_t>(random.below(65536));
    const LandmarkRecord back = over_the_wire(r, 5, above);
    ASSERT_TRUE(rig.map.apply(back)) << "trial " << trial;
    ASSERT_EQ(back.id, r.id);
    ASSERT_EQ(back.removed, r.removed);
    ASSERT_EQ(back.revision, 5u + above);
    if (r.removed) continue;
    ASSERT_EQ(back.observations, std::min<int>(r.observations, 255));
    // Half a millimetre, and a float's own rounding.
    const auto near = [](float a, float b) {
      return std::abs(a - b) <= 0.0005F + 6e-8F * std::abs(a);
    };
    ASSERT_TRUE(near(r.x_m, back.x_m) && near(r.y_m, back.y_m) && near(r.z_m, back.z_m));
    for (const std::size_t i : {0u, 3u, 5u}) {
      ASSERT_GE(back.covariance_m2[i], r.covariance_m2[i]) << "trial " << trial;
      const double most = std::max(1e-4, std::sqrt(r.covariance_m2[i]) * std::exp2(1.0 / 16.0));
      ASSERT_LE(std::sqrt(back.covariance_m2[i]), most * (1.0 + 1e-6)) << "trial " << trial;
    }
    ASSERT_EQ(back.appearance_count, r.appearance_count);
    for (std::size_t i = 0; i < r.appearance_count; ++i) {
      const AppearanceRecord& a = r.appearances[i];
      const AppearanceRecord& b = back.appearances[i];
      ASSERT_LE(std::abs(wrap_angle(a.direction_rad - b.direction_rad)),
                std::numbers::pi / 256.0 + 1e-6);
      int largest = 1;
      for (const std::int8_t v : a.descriptor) largest = std::max(largest, std::abs(int{v}));
      for (std::size_t k = 0; k < a.descriptor.size(); ++k) {
        // Half the step around it: between code c and the next one it is 1.12 c + 0.56.
        const double scaled = a.descriptor[k] * 126.0 / largest;
        const double step = 1.12 * std::sqrt(std::abs(scaled) / 0.56) + 0.56;
        ASSERT_LE(std::abs(scaled - b.descriptor[k]), 0.5 * step + 1.0) << "rounded to whole ones";
      }
    }
  }
}

TEST(ExchangeCodeProperty, CorrelationsShrinkAndKeepTheirSigns) {
  const TestSeed seed;
  Random random(seed.value());
  for (int trial = 0; trial < 20000; ++trial) {
    const std::array<float, 6> c = random_covariance(random);
    const Correlations r = encode_correlations(c);
    ASSERT_TRUE(semidefinite(r));
    const std::array<double, 3> truth = {c[1] / std::sqrt(double{c[0]} * c[3]),
                                         c[2] / std::sqrt(double{c[0]} * c[5]),
                                         c[4] / std::sqrt(double{c[3]} * c[5])};
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_GE(r[i] * truth[i], 0.0);
      ASSERT_LE(std::abs(r[i] / 127.0), std::abs(truth[i]) + 1e-6);
      ASSERT_GE(std::abs(r[i] / 127.0), 0.85 * std::min(1.0, std::abs(truth[i])) - 2.0 / 127.0)
          << "trial " << trial;
    }
  }
}

TEST(ExchangeCodeProperty, WhatWasDecodedIsEncodedTheSame) {
  const TestSeed seed;
  Random random(seed.value());
  for (int trial = 0; trial < 4000; ++trial) {
    const LandmarkRecord once = over_the_wire(random_record(random), 1, 0);
    EncodedRecord first;
    EncodedRecord second;
    ASSERT_TRUE(encode_record(once, first));
    const LandmarkRecord twice = over_the_wire(once, 1, 0);
    ASSERT_TRUE(encode_record(twice, second));
    ASSERT_EQ(once.x_m, twice.x_m);
    ASSERT_EQ(once.covariance_m2, twice.covariance_m2) << "also after many lives of a map";
    for (std::size_t i = 0; i < once.appearance_count; ++i) {
      ASSERT_EQ(once.appearances[i].descriptor, twice.appearances[i].descriptor);
      ASSERT_EQ(once.appearances[i].direction_rad, twice.appearances[i].direction_rad);
    }
  }
}

}  // namespace
}  // namespace zenith::exchange
