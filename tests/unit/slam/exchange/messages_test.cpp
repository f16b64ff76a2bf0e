#include "slam/exchange/messages.h"

#include <limits>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "slam/exchange/records_section.h"
#include "tests/unit/slam/exchange/hex.h"

namespace zenith::exchange {
namespace {

// What append() writes, as text.
template <typename Append>
std::string section(const Append& append_to) {
  std::array<std::uint8_t, kMaxPayload> room = {};
  ByteWriter out(room);
  EXPECT_TRUE(append_to(out));
  const std::string text = to_hex(out.written());
  // Whatever fits not whole is not written at all.
  for (std::size_t size = 0; size < out.size(); ++size) {
    ByteWriter small(std::span<std::uint8_t>(room).first(size));
    EXPECT_FALSE(append_to(small)) << size;
    EXPECT_EQ(small.size(), 0u);
    EXPECT_FALSE(small.failed());
  }
  return text;
}

std::string spaced(std::string_view text) {
  return to_hex(from_hex(text));
}

// The body of the golden section, cut and lengthened: neither may decode.
template <typename Message>
void expect_exact_length(std::string_view golden) {
  auto bytes = from_hex(golden);
  bytes.push_back(0);
  const Bytes body = Bytes(bytes).subspan(kSectionHeader);
  Message message;
  for (std::size_t size = 0; size <= body.size(); ++size) {
    EXPECT_EQ(decode(body.first(size), message), size + 1 == body.size()) << size;
  }
}

Hello hello(std::string_view name) {
  Hello h;
  for (const char c : name) h.name.push_back(c);
  return h;
}

TEST(Messages, HelloInBytes) {
  constexpr const char* kGolden = "01 07 00  06 72 c3 b6 74 2d 31";
  EXPECT_EQ(section([](ByteWriter& o) { return append(o, hello("r\xC3\xB6t-1")); }),
            spaced(kGolden));
  expect_exact_length<Hello>(kGolden);
  Hello read;
  const auto bytes = from_hex(kGolden);
  ASSERT_TRUE(decode(Bytes(bytes).subspan(3), read));
  EXPECT_EQ(read.text(), "r\xC3\xB6t-1");
}

TEST(Messages, ChallengeAndResponseInBytes) {
  Challenge c;
  c.robot = 0x0102030405060708U;
  c.boot = 0xA1A2A3A4A5A6A7A8U;
  for (std::size_t i = 0; i < 16; ++i) c.nonce[i] = static_cast<std::uint8_t>(0x10 + i);
  constexpr const char* kBody =
      "20 00  08 07 06 05 04 03 02 01  a8 a7 a6 a5 a4 a3 a2 a1"
      "10 11 12 13 14 15 16 17 18 19 1a 1b 1c 1d 1e 1f";
  EXPECT_EQ(section([&](ByteWriter& o) { return append(o, SectionType::kChallenge, c); }),
            spaced(std::string("02") + kBody));
  EXPECT_EQ(section([&](ByteWriter& o) { return append(o, SectionType::kResponse, c); }),
            spaced(std::string("03") + kBody));
  expect_exact_length<Challenge>(std::string("03") + kBody);
  Challenge read;
  const auto bytes = from_hex(std::string("03") + kBody);
  ASSERT_TRUE(decode(Bytes(bytes).subspan(3), read));
  EXPECT_EQ(read.robot, c.robot);
  EXPECT_EQ(read.boot, c.boot);
  EXPECT_EQ(read.nonce, c.nonce);
}

StateNotice golden_state() {
  StateNotice s;
  s.map = 0x11121314;
  s.head = 0x00212223;
  s.present = 0x0132;
  s.checksum = 0x4142434445464748U;
  s.T_start_robot = {1.5, -2.001, std::numbers::pi / 2.0};
  s.health = Health::kMerged;
  AlignmentNotice a;
  a.robot = 0x5152535455565758U;
  a.map = 0x61626364;
  a.state = AlignmentNotice::State::kMerged;
  a.T_own_peer = {-0.001, 70.0, -std::numbers::pi / 4.0};
  a.deviations = {1e-4, 0.01, 100.0};
  a.correspondences = 0x0172;
  a.confidence = 0.5;
  s.alignments.push_back(a);
  return s;
}

constexpr const char* kGoldenState =
    "04 3e 00  14 13 12 11  23 22 21 00  32 01 00 00  48 47 46 45 44 43 42 41"
    "dc 05 00 00  2f f8 ff ff  00 40  02  01"
    "58 57 56 55 54 53 52 51  64 63 62 61  01  ff ff ff ff  70 11 01 00  00 e0"
    "00 6b ff  72 01  00 80";

TEST(Messages, StateInBytes) {
  EXPECT_EQ(section([](ByteWriter& o) { return append(o, golden_state()); }), spaced(kGoldenState));
  expect_exact_length<StateNotice>(kGoldenState);
  EXPECT_EQ(from_hex(kGoldenState).size(), kStateBytes + kAlignmentBytes);
}

TEST(Messages, ReadsState) {
  StateNotice s;
  const auto bytes = from_hex(kGoldenState);
  ASSERT_TRUE(decode(Bytes(bytes).subspan(3), s));
  EXPECT_EQ(s.map, 0x11121314u);
  EXPECT_EQ(s.head, 0x00212223u);
  EXPECT_EQ(s.present, 0x0132u);
  EXPECT_EQ(s.checksum, 0x4142434445464748u);
  EXPECT_DOUBLE_EQ(s.T_start_robot.x_m, 1.5);
  EXPECT_DOUBLE_EQ(s.T_start_robot.y_m, -2.001);
  EXPECT_DOUBLE_EQ(s.T_start_robot.theta_rad, std::numbers::pi / 2.0);
  EXPECT_EQ(s.health, Health::kMerged);
  ASSERT_EQ(s.alignments.size(), 1u);
  const AlignmentNotice& a = s.alignments[0];
  EXPECT_EQ(a.robot, 0x5152535455565758u);
  EXPECT_EQ(a.map, 0x61626364u);
  EXPECT_EQ(a.state, AlignmentNotice::State::kMerged);
  EXPECT_DOUBLE_EQ(a.T_own_peer.x_m, -0.001);
  EXPECT_DOUBLE_EQ(a.T_own_peer.y_m, 70.0);
  EXPECT_DOUBLE_EQ(a.T_own_peer.theta_rad, -std::numbers::pi / 4.0);
  EXPECT_DOUBLE_EQ(a.deviations[0], 1e-4);
  EXPECT_NEAR(a.deviations[1], 0.0103, 1e-4);
  EXPECT_NEAR(a.deviations[2], 6.28, 0.01);
  EXPECT_EQ(a.correspondences, 0x0172);
  EXPECT_NEAR(a.confidence, 0.5, 1e-5);
}

TEST(Messages, RefusesUnknownStatesAndTooManyAlignments) {
  const auto refused = [](std::size_t at, std::uint8_t value) {
    auto bytes = from_hex(kGoldenState);
    bytes[kSectionHeader + at] = value;
    StateNotice s;
    return !decode(Bytes(bytes).subspan(kSectionHeader), s);
  };
  EXPECT_FALSE(refused(30, 4));
  EXPECT_TRUE(refused(30, 5));       // health
  EXPECT_TRUE(refused(31, 2));       // more alignments than bytes
  EXPECT_TRUE(refused(32 + 12, 3));  // state of the alignment
  EXPECT_TRUE(refused(11, 1));       // more landmarks than revisions
}

TEST(Messages, WhatIsNoNumberIsToldAsNothing) {
  StateNotice s;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  s.T_start_robot = {kNan, std::numeric_limits<double>::infinity(), kNan};
  AlignmentNotice a;
  a.deviations = {kNan, -1.0, 0.0};
  a.confidence = kNan;
  s.alignments.push_back(a);
  std::array<std::uint8_t, kMaxPayload> room = {};
  ByteWriter out(room);
  ASSERT_TRUE(append(out, s));
  StateNotice read;
  ASSERT_TRUE(decode(out.written().subspan(kSectionHeader), read));
  EXPECT_EQ(read.T_start_robot.x_m, 0.0);
  EXPECT_EQ(read.T_start_robot.y_m, 2147483.647);
  EXPECT_EQ(read.T_start_robot.theta_rad, 0.0);
  EXPECT_NEAR(read.alignments[0].deviations[0], 6.28, 0.01);
  EXPECT_EQ(read.alignments[0].deviations[1], 1e-4);
  EXPECT_EQ(read.alignments[0].confidence, 0.0);
}

TEST(Messages, RequestInBytes) {
  Request r;
  r.robot = 0x0102030405060708U;
  r.map = 0xB1B2B3B4U;
  r.ranges.push_back({1, 0x0203});
  r.ranges.push_back({0x00030405, kToHead});
  constexpr const char* kGolden =
      "06 1d 00  08 07 06 05 04 03 02 01  b4 b3 b2 b1  02"
      "01 00 00 00  03 02 00 00   05 04 03 00  ff ff ff ff";
  EXPECT_EQ(section([&](ByteWriter& o) { return append(o, r); }), spaced(kGolden));
  expect_exact_length<Request>(kGolden);
  EXPECT_EQ(from_hex(kGolden).size(), kRequestBytes + 2 * kRangeBytes);
  Request read;
  auto bytes = from_hex(kGolden);
  ASSERT_TRUE(decode(Bytes(bytes).subspan(3), read));
  EXPECT_EQ(read.robot, r.robot);
  EXPECT_EQ(read.map, r.map);
  ASSERT_EQ(read.ranges.size(), 2u);
  EXPECT_EQ(read.ranges[1], r.ranges[1]);
  bytes[3 + 13] = 0;  // first = 0
  EXPECT_FALSE(decode(Bytes(bytes).subspan(3), read));
  bytes[3 + 14] = 3;  // first = 0x0300, beyond last
  EXPECT_FALSE(decode(Bytes(bytes).subspan(3), read));
}

TEST(Messages, ByeInBytes) {
  EXPECT_EQ(section([](ByteWriter& o) { return append_bye(o); }), spaced("07 00 00"));
}

// Two records of revisions 0x1000 and 0x1002; 0x1001 and 0x1003 are superseded.
constexpr const char* kGoldenRecords =
    "05 1d 00  a4 a3 a2 a1  00 10 00 00  03 10 00 00  02"
    "07 00 00 00  00 00  80 00   09 00 00 00  02 00  80 05";

TEST(Messages, RecordsInBytes) {
  const auto write = [](ByteWriter& o) {
    LandmarkRecord r;
    r.removed = true;
    EncodedRecord encoded;
    RecordsWriter records(o, 0xA1A2A3A4U, 0x1000);
    r.id = 7;
    bool fits = encode_record(r, encoded) && records.add(encoded, 0x1000);
    r.id = 9;
    r.observations = 5;
    fits = fits && encode_record(r, encoded) && records.add(encoded, 0x1002);
    fits = fits && records.finish(0x1003);
    if (!fits) records.cancel();
    return fits;
  };
  EXPECT_EQ(section(write), spaced(kGoldenRecords));
}

TEST(Messages, ReadsRecords) {
  const auto bytes = from_hex(kGoldenRecords);
  RecordsReader records(Bytes(bytes).subspan(kSectionHeader));
  EXPECT_EQ(records.header().map, 0xA1A2A3A4u);
  EXPECT_EQ(records.header().range, (Range{0x1000, 0x1003}));
  LandmarkRecord r;
  ASSERT_TRUE(records.next(r));
  EXPECT_EQ(r.id, 7u);
  EXPECT_EQ(r.revision, 0x1000u);
  ASSERT_TRUE(records.next(r));
  EXPECT_EQ(r.id, 9u);
  EXPECT_EQ(r.revision, 0x1002u);
  EXPECT_EQ(r.observations, 5);
  EXPECT_FALSE(records.next(r));
  EXPECT_FALSE(records.malformed());
}

TEST(Messages, RecordsMustRiseInsideTheirRange) {
  const auto malformed = [](std::size_t at, std::uint8_t value) {
    auto bytes = from_hex(kGoldenRecords);
    bytes[at] = value;
    return !well_formed(bytes);
  };
  EXPECT_FALSE(malformed(3, 0));
  EXPECT_FALSE(malformed(28, 3));
  EXPECT_TRUE(malformed(28, 0));     // the revision before again
  EXPECT_TRUE(malformed(28, 4));     // beyond last
  EXPECT_TRUE(malformed(15, 1));     // a record too many
  EXPECT_TRUE(malformed(15, 3));     // one too few
  EXPECT_TRUE(malformed(12, 0x0F));  // last before first
}

TEST(Messages, UnknownSectionsArePassedOverCutOnesAreMalformed) {
  EXPECT_TRUE(well_formed(from_hex("")));
  EXPECT_TRUE(well_formed(from_hex("63 02 00 aa bb  07 00 00")));
  EXPECT_FALSE(well_formed(from_hex("63 02 00 aa bb  07 01 00 00")));
  EXPECT_FALSE(well_formed(from_hex("63 03 00 aa bb")));
  EXPECT_FALSE(well_formed(from_hex("63 03")));
}

}  // namespace
}  // namespace zenith::exchange
