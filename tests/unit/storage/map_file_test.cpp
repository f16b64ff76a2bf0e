// A map in bytes: what goes in comes out, and nothing wrong is taken for right.

#include "platform/storage/map_file.h"

#include <gtest/gtest.h>

#include "tests/support/figure.h"
#include "tests/support/seeds.h"
#include "tests/support/stored_maps.h"

namespace zenith::storage {
namespace {

TEST(MapFile, ComesBackAsItWasWritten) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  for (const std::size_t count :
       {std::size_t{0}, std::size_t{1}, std::size_t{64}, std::size_t{65}, std::size_t{700}}) {
    StoredMap map = random_map(count, random);
    map.head.checkpoint = 77;
    const auto bytes = encode_map(map);
    const DecodedMap decoded = decode_map(bytes);
    ASSERT_EQ(decoded.fault, MapFault::kNone) << decoded.reason;
    EXPECT_EQ(decoded.map.head.map, map.head.map);
    EXPECT_EQ(decoded.map.head.checkpoint, 77u);
    EXPECT_EQ(decoded.map.head.saved_s, map.head.saved_s);
    EXPECT_EQ(decoded.map.head.robot.view(), "ada");
    EXPECT_EQ(decoded.map.head.camera_height_m, 0.3);
    EXPECT_EQ(decoded.map.head.rectified_fov_deg, 120.0);
    ASSERT_EQ(decoded.map.landmarks.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      const LandmarkRecord& a = map.landmarks[i];
      const LandmarkRecord& b = decoded.map.landmarks[i];
      EXPECT_EQ(a.id, b.id);
      EXPECT_NEAR(a.x_m, b.x_m, 0.0006);
      EXPECT_NEAR(a.y_m, b.y_m, 0.0006);
      EXPECT_NEAR(a.z_m, b.z_m, 0.0006);
      EXPECT_EQ(a.appearance_count, b.appearance_count);
    }
    // Written again and again, nothing moves.
    const DecodedMap again = decode_map(encode_map(decoded.map));
    for (std::size_t i = 0; i < count; ++i) {
      const LandmarkRecord& a = decoded.map.landmarks[i];
      const LandmarkRecord& b = again.map.landmarks[i];
      EXPECT_EQ(a.x_m, b.x_m);
      EXPECT_EQ(a.covariance_m2[0], b.covariance_m2[0]);
      EXPECT_EQ(a.appearances[0].descriptor, b.appearances[0].descriptor);
      EXPECT_EQ(a.appearances[0].direction_rad, b.appearances[0].direction_rad);
    }
  }
}

TEST(MapFile, AFullMapIsRead) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  StoredMap map = random_map(kMaxStoredLandmarks + 10, random);
  for (LandmarkRecord& r : map.landmarks) r.appearance_count = kPublishedAppearances;
  const auto bytes = encode_map(map);
  EXPECT_LE(bytes.size(), kMaxMapBytes);
  print_figure("stored map: %zu landmarks with %d looks each in %zu bytes", kMaxStoredLandmarks,
               kPublishedAppearances, bytes.size());
  const DecodedMap decoded = decode_map(bytes);
  ASSERT_EQ(decoded.fault, MapFault::kNone) << decoded.reason;
  EXPECT_EQ(decoded.map.landmarks.size(), kMaxStoredLandmarks);
}

TEST(MapFile, ARobotWithAnUnspeakableNameIsRefused) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  StoredMap map = random_map(3, random);
  for (const char* name : {"r1\x1b[31m", "a\nb", "\u202egnp", "\xff"}) {
    map.head.robot.assign(name);
    const DecodedMap decoded = decode_map(encode_map(map));
    EXPECT_EQ(decoded.fault, MapFault::kForeign);
    EXPECT_NE(decoded.reason.find("name"), std::string::npos) << decoded.reason;
    EXPECT_TRUE(decoded.map.landmarks.empty());
  }
  map.head.robot.assign("");
  EXPECT_EQ(decode_map(encode_map(map)).fault, MapFault::kNone);
}

TEST(MapFile, WhatCannotBeToldIsLeftOut) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  StoredMap map = random_map(3, random);
  map.landmarks[0].removed = true;
  map.landmarks[1].x_m = 1e9F;
  const DecodedMap decoded = decode_map(encode_map(map));
  ASSERT_EQ(decoded.fault, MapFault::kNone) << decoded.reason;
  ASSERT_EQ(decoded.map.landmarks.size(), 1u);
  EXPECT_EQ(decoded.map.landmarks[0].id, 3u);
}

TEST(MapFile, EveryChangedByteAndEveryLengthIsNoticed) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  const auto good = encode_map(random_map(70, random));
  auto bytes = good;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1u << (at % 8)));
    EXPECT_NE(decode_map(bytes).fault, MapFault::kNone) << "byte " << at;
    bytes[at] = good[at];
  }
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_NE(decode_map(Bytes(good).first(size)).fault, MapFault::kNone) << size << " bytes";
  }
  bytes.push_back(0);
  EXPECT_EQ(decode_map(bytes).fault, MapFault::kDamaged);
}

TEST(MapFile, TellsForeignFromDamaged) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  auto bytes = encode_map(random_map(5, random));
  bytes[8] = 9;  // the version's lower byte
  const DecodedMap newer = decode_map(bytes);
  EXPECT_EQ(newer.fault, MapFault::kForeign);
  EXPECT_EQ(newer.reason, "expected version 1 of the format, found 9");
  bytes[8] = 1;
  bytes[0] = 'x';
  EXPECT_EQ(decode_map(bytes).fault, MapFault::kForeign);
  bytes[0] = 0xB7;
  bytes.resize(bytes.size() / 2);
  EXPECT_EQ(decode_map(bytes).fault, MapFault::kDamaged);
}

}  // namespace
}  // namespace zenith::storage
