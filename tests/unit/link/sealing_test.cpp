#include "platform/link/sealing.h"

#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

SecretKey golden_fleet_key() {
  SecretKey key;
  for (std::size_t i = 0; i < SecretKey::kBytes; ++i) {
    key.bytes()[i] = static_cast<std::uint8_t>(7 * i + 3);
  }
  return key;
}

std::string hex(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

std::vector<std::uint8_t> bytes_of(const std::string& hex) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

// A HELLO of "ada" and a BYE.
const std::vector<std::uint8_t> kPayload = {1, 4, 0, 3, 'a', 'd', 'a', 7, 0, 0};
constexpr std::uint64_t kBoot = 0x1122334455667788;
constexpr std::uint64_t kCounter = 0x0102030405060708;

std::vector<std::uint8_t> golden_datagram() {
  const SecretKey fleet = golden_fleet_key();
  FrameHeader header;
  header.key_hint = key_hint(fleet);
  header.sender = masked(fleet, {robot_id("ada"), kBoot});
  header.counter = kCounter;
  std::vector<std::uint8_t> datagram(kMaxDatagramBytes);
  datagram.resize(seal(sender_key(fleet, header.sender), header, kPayload, datagram));
  return datagram;
}

// The figures come from a second implementation: ChaCha20-Poly1305 written from the text of RFC
// 8439 in Python, checked with the RFC's own vector (2.8.2), and the BLAKE2b of Python's hashlib.
TEST(Sealing, IsByteForByteWhatTheProtocolSays) {
  const SecretKey fleet = golden_fleet_key();
  EXPECT_EQ(hint_text(key_hint(fleet)), "2439");
  EXPECT_EQ(robot_id("ada"), 0x4a77e624bd6b07d4U);
  const SenderId shown = masked(fleet, {robot_id("ada"), kBoot});
  EXPECT_EQ(shown, (SenderId{0x288f93880cfe897eU, kBoot}));
  EXPECT_EQ(hex(sender_key(fleet, shown).bytes()),
            "a4f700a11a72b4cb744f583fb45e7a1f59510a375871fd01f48999ff8b25d589");
  EXPECT_EQ(hex(golden_datagram()),
            "5a4e0202020024397e89fe0c88938f2888776655443322110807060504030201"
            "7e4877af68902ec89a0976daeb526ff7c4486f44b37aab5f8a20");
}

// The datagram of version 1, whose header shows the plain robot: its tag is right.
TEST(Sealing, OpensTheFrameOfVersionOne) {
  const auto datagram = bytes_of(
      "5a4e010101002439d4076bbd24e6774a88776655443322110807060504030201"
      "095e86646d5dc7acd84edd46e9ddedbb58514dfd6863ee8b77aa");
  FrameHeader header;
  ASSERT_TRUE(read_header(datagram, header));
  EXPECT_EQ(header.version, 1);
  EXPECT_EQ(header.sender, (SenderId{robot_id("ada"), kBoot}));
  std::array<std::uint8_t, kMaxPayloadBytes> payload;
  std::size_t size = 0;
  EXPECT_TRUE(open(sender_key(golden_fleet_key(), header.sender), datagram, payload, size));
}

TEST(Sealing, OpensWhatItSealed) {
  const auto datagram = golden_datagram();
  FrameHeader header;
  ASSERT_TRUE(read_header(datagram, header));
  EXPECT_EQ(header.version, 2);
  EXPECT_EQ(header.version_min, 2);
  EXPECT_EQ(header.version_max, 2);
  EXPECT_EQ(header.counter, kCounter);
  EXPECT_EQ(masked(golden_fleet_key(), header.sender), (SenderId{robot_id("ada"), kBoot}));
  std::array<std::uint8_t, kMaxPayloadBytes> payload;
  std::size_t size = 0;
  ASSERT_TRUE(open(sender_key(golden_fleet_key(), header.sender), datagram, payload, size));
  EXPECT_EQ(std::vector<std::uint8_t>(payload.begin(), payload.begin() + size), kPayload);
}

// A datagram without room for a header and a tag, and a place too small for what is in it.
TEST(Sealing, LengthsThatCannotBeOpenNothing) {
  const auto datagram = golden_datagram();
  FrameHeader header;
  ASSERT_TRUE(read_header(datagram, header));
  const SecretKey key = sender_key(golden_fleet_key(), header.sender);
  std::array<std::uint8_t, kMaxPayloadBytes> payload = {};
  std::size_t size = 7;
  for (std::size_t length = 0; length < kHeaderBytes + kTagBytes; ++length) {
    EXPECT_FALSE(open(key, std::span(datagram).first(length), payload, size)) << length;
    EXPECT_EQ(size, 0u);
  }
  EXPECT_FALSE(open(key, datagram, std::span(payload).first(kPayload.size() - 1), size));
  EXPECT_EQ(payload[1], 0u) << "nothing was written";
}

TEST(Sealing, AnyBitThatIsFlippedShows) {
  const auto good = golden_datagram();
  std::array<std::uint8_t, kMaxPayloadBytes> payload;
  std::size_t size = 0;
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    auto datagram = good;
    datagram[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    FrameHeader header;
    if (!read_header(datagram, header)) {
      EXPECT_LT(bit, 16u);  // the magic
      continue;
    }
    EXPECT_FALSE(open(sender_key(golden_fleet_key(), header.sender), datagram, payload, size))
        << "bit " << bit;
    EXPECT_EQ(size, 0u);
  }
}

TEST(Sealing, NoOtherLengthIsADatagram) {
  const auto good = golden_datagram();
  FrameHeader header;
  std::array<std::uint8_t, kMaxPayloadBytes> payload;
  std::size_t size = 0;
  const SecretKey key =
      sender_key(golden_fleet_key(), masked(golden_fleet_key(), {robot_id("ada"), kBoot}));
  for (std::size_t length = 0; length < good.size(); ++length) {
    const auto cut = std::span(good).first(length);
    const bool opened = read_header(cut, header) && open(key, cut, payload, size);
    EXPECT_FALSE(opened) << length << " bytes";
  }
  auto longer = good;
  longer.push_back(0);
  ASSERT_TRUE(read_header(longer, header));
  EXPECT_FALSE(open(key, longer, payload, size));
  std::vector<std::uint8_t> too_long(kMaxDatagramBytes + 1);
  std::copy(good.begin(), good.end(), too_long.begin());
  EXPECT_FALSE(read_header(too_long, header));
  EXPECT_TRUE(read_header(std::span(too_long).first(kMaxDatagramBytes), header));
}

TEST(Sealing, EachBootOfEachRobotHasItsOwnKey) {
  const SecretKey fleet = golden_fleet_key();
  const SecretKey key = sender_key(fleet, {1, 1});
  EXPECT_FALSE(key == sender_key(fleet, {1, 2}));
  EXPECT_FALSE(key == sender_key(fleet, {2, 1}));
  EXPECT_FALSE(key == sender_key(SecretKey::random(), {1, 1}));
  EXPECT_TRUE(key == sender_key(fleet, {1, 1}));
}

TEST(Sealing, PayloadsOfAllLengthsComeBack) {
  const TestSeed seed;
  Random random(seed.value());
  const SecretKey key = SecretKey::random();
  std::array<std::uint8_t, kMaxDatagramBytes> datagram;
  std::array<std::uint8_t, kMaxPayloadBytes> payload;
  std::array<std::uint8_t, kMaxPayloadBytes> opened;
  for (std::size_t length = 0; length <= kMaxPayloadBytes; ++length) {
    for (std::size_t i = 0; i < length; ++i) {
      payload[i] = static_cast<std::uint8_t>(random.next_u32());
    }
    FrameHeader header;
    header.counter = length + 1;
    const auto content = std::span<const std::uint8_t>(payload).first(length);
    const std::size_t size = seal(key, header, content, datagram);
    ASSERT_EQ(size, length + kHeaderBytes + kTagBytes);
    std::size_t back = 0;
    ASSERT_TRUE(open(key, std::span(datagram).first(size), opened, back));
    ASSERT_TRUE(std::equal(content.begin(), content.end(), opened.begin(), opened.begin() + back));
  }
}

}  // namespace
}  // namespace zenith
