#include "slam/exchange/record_code.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/unit/slam/exchange/hex.h"

namespace zenith::exchange {
namespace {

LandmarkRecord golden_record() {
  LandmarkRecord r;
  r.id = 0x01020304;
  r.observations = 300;
  r.x_m = 1.234F;
  r.y_m = -2.5F;
  r.z_m = 2.75F;
  // Deviations 10, 20 and 0.095 mm; correlations 0.5, -0.2535 and 0.
  r.covariance_m2 = {1e-4F, 1e-4F, -2.405e-7F, 4e-4F, 0.0F, 0.9e-8F};
  r.appearance_count = 2;
  r.appearances[0].direction_rad = std::numbers::pi_v<float> / 2.0F;
  r.appearances[0].descriptor = {127, -127, 0, 18, -18, 64};
  r.appearances[1].direction_rad = -std::numbers::pi_v<float> / 4.0F;
  r.appearances[1].descriptor[31] = -5;
  return r;
}

constexpr const char* kGolden =
    "04 03 02 01  06 05  02 ff  d2 04 00  3c f6 ff  be 0a 00  6b 7b 00  3f e0 00"
    "40 2f 02 a3 17 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00"
    "e0 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 88";

std::vector<std::uint8_t> bytes_of(const LandmarkRecord& r, std::uint16_t revision) {
  EncodedRecord encoded;
  EXPECT_TRUE(encode_record(r, encoded));
  std::array<std::uint8_t, kMaxRecordBytes> room = {};
  ByteWriter out(room);
  append_record(out, encoded, revision);
  return {out.written().begin(), out.written().end()};
}

TEST(RecordCode, GoldenBytes) {
  EXPECT_EQ(to_hex(bytes_of(golden_record(), 0x0506)), to_hex(from_hex(kGolden)));
}

TEST(RecordCode, GoldenBytesOfARemovedLandmark) {
  LandmarkRecord r;
  r.id = 0x0A0B0C0D;
  r.removed = true;
  r.observations = 7;
  r.x_m = std::numeric_limits<float>::quiet_NaN();  // does not matter any more
  EXPECT_EQ(to_hex(bytes_of(r, 0x0102)), to_hex(from_hex("0d 0c 0b 0a 02 01 80 07")));
}

TEST(RecordCode, ReadsGoldenBytes) {
  const auto bytes = from_hex(kGolden);
  ByteReader in(bytes);
  LandmarkRecord r;
  ASSERT_TRUE(decode_record(in, 1000000, r));
  EXPECT_TRUE(in.done());
  EXPECT_EQ(r.id, 0x01020304u);
  EXPECT_EQ(r.revision, 1000000u + 0x0506u);
  EXPECT_FALSE(r.removed);
  EXPECT_EQ(r.observations, 255);
  EXPECT_FLOAT_EQ(r.x_m, 1.234F);
  EXPECT_FLOAT_EQ(r.y_m, -2.5F);
  EXPECT_FLOAT_EQ(r.z_m, 2.75F);
  EXPECT_NEAR(std::sqrt(r.covariance_m2[0]), 1e-4 * std::exp2(107.0 / 16.0), 1e-8);
  EXPECT_NEAR(std::sqrt(r.covariance_m2[3]), 1e-4 * std::exp2(123.0 / 16.0), 1e-8);
  EXPECT_NEAR(std::sqrt(r.covariance_m2[5]), 1e-4, 1e-8);
  EXPECT_NEAR(r.covariance_m2[1] / std::sqrt(r.covariance_m2[0] * r.covariance_m2[3]), 63.0 / 127.0,
              1e-6);
  EXPECT_NEAR(r.covariance_m2[2] / std::sqrt(r.covariance_m2[0] * r.covariance_m2[5]),
              -32.0 / 127.0, 1e-6);
  EXPECT_EQ(r.covariance_m2[4], 0.0F);
  ASSERT_EQ(r.appearance_count, 2);
  EXPECT_FLOAT_EQ(r.appearances[0].direction_rad, std::numbers::pi_v<float> / 2.0F);
  EXPECT_FLOAT_EQ(r.appearances[1].direction_rad, -std::numbers::pi_v<float> / 4.0F);
  const Coefficients first = {126, -126, 0, 20, -20, 68};
  EXPECT_EQ(r.appearances[0].descriptor, first);
  EXPECT_EQ(r.appearances[1].descriptor[31], -126);
}

TEST(RecordCode, RefusesWhatCannotBeTold) {
  EncodedRecord encoded;
  const auto refused = [&](auto change) {
    LandmarkRecord r = golden_record();
    change(r);
    return !encode_record(r, encoded);
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(refused([](LandmarkRecord&) {}));
  EXPECT_TRUE(refused([](LandmarkRecord& r) { r.x_m = kNan; }));
  EXPECT_TRUE(refused([](LandmarkRecord& r) { r.y_m = -kInfinity; }));
  EXPECT_TRUE(refused([](LandmarkRecord& r) { r.z_m = 8389.0F; }));
  EXPECT_FALSE(refused([](LandmarkRecord& r) { r.z_m = 8388.0F; }));
  EXPECT_TRUE(refused([](LandmarkRecord& r) { r.covariance_m2[1] = kNan; }));
  EXPECT_TRUE(refused([](LandmarkRecord& r) { r.covariance_m2[3] = -1e-6F; }));
  EXPECT_TRUE(refused([](LandmarkRecord& r) { r.covariance_m2[5] = 40.0F; }));
  EXPECT_FALSE(refused([](LandmarkRecord& r) { r.covariance_m2[5] = 39.0F; }));
  EXPECT_FALSE(refused([](LandmarkRecord& r) { r.covariance_m2[1] = 1.0F; }));
}

TEST(RecordCode, RefusesMalformedBytes) {
  const auto refused = [](std::size_t at, std::uint8_t value) {
    auto bytes = from_hex(kGolden);
    bytes[at] = value;
    ByteReader in(bytes);
    LandmarkRecord r;
    return !decode_record(in, 1, r);
  };
  EXPECT_FALSE(refused(0, 0x77));
  EXPECT_TRUE(refused(6, 8));  // looks
  EXPECT_TRUE(refused(6, 3));  // more looks than bytes
  auto lowest = from_hex(kGolden);
  lowest[8] = lowest[9] = 0;
  lowest[10] = 0x80;  // -2^23
  ByteReader in(lowest);
  LandmarkRecord r;
  EXPECT_FALSE(decode_record(in, 1, r));
  EXPECT_TRUE(refused(20, 0x80));  // correlation -128
  EXPECT_TRUE(refused(22, 0x7F));  // 0.5, -0.25 and 1 together are no correlations
  EXPECT_TRUE(refused(24, 0x30));  // code -16
  for (std::size_t size = 0; size < from_hex(kGolden).size(); ++size) {
    const auto bytes = from_hex(kGolden);
    ByteReader cut(Bytes(bytes).first(size));
    EXPECT_FALSE(decode_record(cut, 1, r)) << size;
  }
  const auto bytes = from_hex(kGolden);
  ByteReader wrapped(bytes);
  EXPECT_FALSE(decode_record(wrapped, 0xFFFFFF00U, r)) << "revision beyond 32 bits";
}

}  // namespace
}  // namespace zenith::exchange
