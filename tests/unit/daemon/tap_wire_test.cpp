#include "platform/daemon/tap/wire.h"

#include <algorithm>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/base/printable.h"
#include "platform/base/random.h"
#include "platform/config/robot_settings.h"
#include "tests/support/lenses.h"
#include "tests/support/seeds.h"

namespace zenith::tap {
namespace {

using testing::HasSubstr;

Hello full_hello() {
  Hello hello;
  hello.robot = "ada";
  hello.software = "zenithd 9";
  hello.devices = "a camera, a bus";
  hello.config.lens = {648, 486, 151, 152, 321, 242, {0.1, -0.2, 0.3, -0.4}};
  hello.config.mount = {1, 2, 3, 0.4, 0.5, 0.6};
  hello.config.wheels = {0.37, 1.01, 0.99};
  hello.config.frame_rate_hz = 12.5;
  hello.can_interface = "can7";
  hello.odometry.kind = WheelCodecKind::kOdrive;
  hello.odometry.invert_right = true;
  hello.odometry.geometry.gear_ratio = 2.5;
  hello.odometry.odrive.left_node = 5;
  hello.odometry.vesc.quantity = WheelQuantity::kVelocity;
  hello.odometry.dbc.file = "some/base.dbc";
  hello.dbc = "VERSION \"\"\n";
  return hello;
}

std::span<const std::uint8_t> fields_of(std::span<const std::uint8_t> message) {
  return message.subspan(kHeaderBytes);
}

TEST(TapWire, HelloTellsAllOfTheRobot) {
  const Hello hello = full_hello();
  const auto bytes = write_hello(hello);
  const auto header = read_header(std::span(bytes).first<kHeaderBytes>());
  ASSERT_TRUE(header.ok());
  EXPECT_EQ(header->type, MessageType::kHello);
  EXPECT_EQ(header->length, bytes.size() - kHeaderBytes);
  const auto read = read_hello(fields_of(bytes));
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->robot, "ada");
  EXPECT_EQ(read->software, "zenithd 9");
  EXPECT_EQ(read->devices, "a camera, a bus");
  EXPECT_EQ(read->config.lens.width_px, 648);
  EXPECT_EQ(read->config.lens.height_px, 486);
  EXPECT_EQ(read->config.lens.cv_px, 242);
  EXPECT_EQ(read->config.lens.k, hello.config.lens.k);
  EXPECT_EQ(read->config.mount.z_m, 3);
  EXPECT_EQ(read->config.mount.yaw_rad, 0.6);
  EXPECT_EQ(read->config.wheels.right_scale, 0.99);
  EXPECT_EQ(read->config.frame_rate_hz, 12.5);
  EXPECT_EQ(read->can_interface, "can7");
  EXPECT_EQ(read->odometry.kind, WheelCodecKind::kOdrive);
  EXPECT_TRUE(read->odometry.invert_right);
  EXPECT_FALSE(read->odometry.invert_left);
  EXPECT_EQ(read->odometry.geometry.gear_ratio, 2.5);
  EXPECT_EQ(read->odometry.odrive.left_node, 5u);
  EXPECT_EQ(read->odometry.vesc.quantity, WheelQuantity::kVelocity);
  EXPECT_EQ(read->odometry.dbc.file, "some/base.dbc");
  EXPECT_EQ(read->dbc, hello.dbc);
}

TEST(TapWire, HelloTellsLensesOfAllModels) {
  for (const auto& [name, lens, whole] : lenses_of_all_models()) {
    Hello hello = full_hello();
    hello.config.lens = lens;
    const auto read = read_hello(fields_of(write_hello(hello)));
    ASSERT_TRUE(read.ok()) << name << ": " << read.error().message;
    EXPECT_TRUE(read->config.lens == lens) << name;
  }
}

TEST(TapWire, EveryCutHelloIsRefused) {
  const auto bytes = write_hello(full_hello());
  const auto fields = fields_of(bytes);
  for (std::size_t size = 0; size < fields.size(); ++size) {
    EXPECT_FALSE(read_hello(fields.first(size)).ok()) << size;
  }
}

// Whatever stands in it, reading ends and stays within the bytes (sanitizers look).
TEST(TapWire, ADamagedHelloDoesNoHarm) {
  const auto whole = write_hello(full_hello());
  for (std::size_t i = kHeaderBytes; i < whole.size(); ++i) {
    for (const int value : {0x00, 0x7F, 0xFF}) {
      auto damaged = whole;
      damaged[i] = static_cast<std::uint8_t>(value);
      (void)read_hello(fields_of(damaged));
    }
  }
}

// Each text is of its kind before anybody uses it.
TEST(TapWire, AnInterfaceThatIsNoneIsRefused) {
  using std::string_literals::operator""s;
  for (const std::string& name :
       {"/etc/cron.d/x\0\n"s, "/etc/passwd"s, "../can0"s, ".."s, ""s, "can 0"s, "can\n0"s,
        "can\x1b[2J"s, "c\xc2\x9b"s, "can0can0can0can0"s, "can0\0"s}) {
    Hello hello = full_hello();
    hello.can_interface = name;
    const auto bytes = write_hello(hello);
    const auto read = read_hello(fields_of(bytes));
    ASSERT_FALSE(read.ok()) << name;
    EXPECT_THAT(read.error().message, HasSubstr("CAN interface"));
    EXPECT_TRUE(is_printable(read.error().message)) << read.error().message;
  }
}

TEST(TapWire, ARobotsNameThatIsNoneIsRefused) {
  for (const std::string& name :
       {std::string(), std::string(33, 'a'), std::string("a\nb"), std::string("\x1b]0;x\x07"),
        std::string("\xc2\x9b"), std::string("\xff")}) {
    Hello hello = full_hello();
    hello.robot = name;
    const auto read = read_hello(fields_of(write_hello(hello)));
    ASSERT_FALSE(read.ok()) << name;
    EXPECT_TRUE(is_printable(read.error().message)) << read.error().message;
  }
}

TEST(TapWire, TextsForPeopleDoNotSteerATerminal) {
  Hello hello = full_hello();
  hello.software = "zenithd \x1b[2J";
  hello.devices = "a camera\nCAN \xc2\x9b \xff";
  const auto read = read_hello(fields_of(write_hello(hello)));
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->software, "zenithd \\x1b[2J");
  EXPECT_EQ(read->devices, "a camera\\x0aCAN \\u009b \\xff");
  std::array<std::uint8_t, 256> room;
  const std::size_t size = write_end({1, 2, 3, 4, 5, 6, "\x1b]0;owned\x07"}, room);
  const auto end = read_end(std::span(room).first(size).subspan(kHeaderBytes));
  ASSERT_TRUE(end.ok());
  EXPECT_TRUE(is_printable(end->why)) << end->why;
  hello.devices = std::string(100'000, 'x');
  EXPECT_FALSE(read_hello(fields_of(write_hello(hello))).ok());
}

TEST(TapWire, KeysAndNumbersOutOfARobotsRangesAreRefused) {
  const auto refused = [](void (*change)(Hello&)) {
    Hello hello = full_hello();
    change(hello);
    return !read_hello(fields_of(write_hello(hello))).ok();
  };
  EXPECT_FALSE(refused([](Hello&) {}));
  EXPECT_TRUE(refused([](Hello& h) { h.config.lens.fu_px = 1e300; }));
  EXPECT_TRUE(refused([](Hello& h) { h.config.mount.x_m = -1e9; }));
  EXPECT_TRUE(refused([](Hello& h) { h.config.frame_rate_hz = 0.0; }));
  EXPECT_TRUE(refused([](Hello& h) { h.odometry.odrive.left_node = 4'000'000'000U; }));
  EXPECT_TRUE(refused([](Hello& h) { h.odometry.geometry.gear_ratio = 1e30; }));
  EXPECT_TRUE(refused([](Hello& h) { h.odometry.dbc.left_signal = "a\nb"; }));
  EXPECT_TRUE(refused([](Hello& h) { h.odometry.dbc.file = "x\x1b[2J"; }));
  EXPECT_TRUE(refused([](Hello& h) { h.dbc = "VERSION \x1b[2J"; }));
  EXPECT_TRUE(refused([](Hello& h) {
    h.odometry.kind = WheelCodecKind::kDbc;
    h.dbc = "BO_ x WHEELS: y\n SG_ ???\n";
  }));
}

// Thousands of messages of which some bytes differ: what is read is of its kind, or refused.
TEST(TapWire, MutatedMessagesAreOfTheirKindOrRefused) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  std::array<std::uint8_t, 512> room;
  std::vector<std::vector<std::uint8_t>> messages = {write_hello(full_hello())};
  const auto add = [&](std::size_t size) {
    const auto written = std::span(room).first(size);
    messages.emplace_back(written.begin(), written.end());
  };
  add(write_can(std::vector<CanFrame>(5, {{11}, 0x311, false, 8, {1, 2, 3}}), room));
  add(write_pose({{21}, {1.5, -2.5, 0.25}}, room));
  add(write_end({1, 2, 3, 4, 5, 6, "why"}, room));
  for (std::size_t i = 0; i < 20'000; ++i) {
    std::vector<std::uint8_t> bytes = messages[i % messages.size()];
    const auto size = static_cast<std::uint32_t>(bytes.size() - kHeaderBytes);
    for (std::uint32_t k = 0; k <= random.below(4); ++k) {
      bytes[kHeaderBytes + random.below(size)] = static_cast<std::uint8_t>(random.below(256));
    }
    const bool is_cut = random.below(4) == 0;
    const auto fields = fields_of(bytes).first(is_cut ? random.below(size) : size);
    if (const auto hello = read_hello(fields); hello.ok()) {
      ASSERT_TRUE(is_robot_name(hello->robot));
      ASSERT_TRUE(is_interface_name(hello->can_interface));
      ASSERT_TRUE(is_printable(hello->software) && is_printable(hello->devices));
    } else {
      ASSERT_TRUE(is_printable(hello.error().message)) << hello.error().message;
    }
    std::vector<CanFrame> frames;
    (void)read_can(fields, frames);
    (void)read_pose(fields);
    std::span<const std::uint8_t> pixels;
    (void)read_frame(fields, pixels);
    const auto end = read_end(fields);
    ASSERT_TRUE(!end.ok() || is_printable(end->why));
  }
}

TEST(TapWire, AnotherVersionIsNamed) {
  auto bytes = write_hello(full_hello());
  bytes[kHeaderBytes + 4] = 9;
  const auto read = read_hello(fields_of(bytes));
  ASSERT_FALSE(read.ok());
  EXPECT_THAT(read.error().message, HasSubstr("version 9"));
}

TEST(TapWire, FramesComeBackAndWrongSizesDoNot) {
  std::vector<std::uint8_t> bytes(kHeaderBytes + kFrameHeadBytes);
  ASSERT_EQ(write_frame_head({{-5}, 77, 3, 2}, bytes), bytes.size());
  const auto header = read_header(std::span(bytes).first<kHeaderBytes>());
  ASSERT_TRUE(header.ok());
  EXPECT_EQ(header->length, kFrameHeadBytes + 6);
  for (std::uint8_t i = 0; i < 6; ++i) bytes.push_back(i);
  std::span<const std::uint8_t> pixels;
  const auto head = read_frame(fields_of(bytes), pixels);
  ASSERT_TRUE(head.ok());
  EXPECT_EQ(head->stamp.ns, -5);
  EXPECT_EQ(head->sequence, 77u);
  EXPECT_EQ(head->width, 3);
  EXPECT_EQ(head->height, 2);
  EXPECT_THAT(pixels, testing::ElementsAre(0, 1, 2, 3, 4, 5));
  bytes.push_back(6);
  EXPECT_FALSE(read_frame(fields_of(bytes), pixels).ok());
  EXPECT_EQ(write_frame_head({}, std::span(bytes).first(kHeaderBytes + 3)), 0u);
}

TEST(TapWire, CanFramesPosesAndEndComeBack) {
  CanFrame a;
  a.stamp = {11};
  a.id = 0x311;
  a.length = 8;
  a.data = {1, 2, 3, 4, 5, 6, 7, 8};
  CanFrame b;
  b.stamp = {12};
  b.id = 0x1FFFFFFF;
  b.extended = true;
  b.length = 2;
  const std::vector<CanFrame> both = {a, b};
  std::array<std::uint8_t, 256> room;
  std::size_t size = write_can(both, room);
  ASSERT_EQ(size, kHeaderBytes + 2 * kCanBytes);
  std::vector<CanFrame> frames;
  ASSERT_TRUE(read_can(std::span(room).first(size).subspan(kHeaderBytes), frames).ok());
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].data, a.data);
  EXPECT_EQ(frames[0].id, 0x311u);
  EXPECT_FALSE(frames[0].extended);
  EXPECT_EQ(frames[1].stamp.ns, 12);
  EXPECT_TRUE(frames[1].extended);
  EXPECT_EQ(frames[1].length, 2);
  room[kHeaderBytes + 13] = 9;  // a length that no classic frame has
  EXPECT_FALSE(read_can(std::span(room).first(size).subspan(kHeaderBytes), frames).ok());
  EXPECT_FALSE(read_can(std::span(room).first(size - 1).subspan(kHeaderBytes), frames).ok());
  EXPECT_EQ(write_can(both, std::span(room).first(40)), 0u);

  size = write_pose({{21}, {1.5, -2.5, 0.25}}, room);
  ASSERT_EQ(size, kHeaderBytes + kPoseBytes);
  const auto pose = read_pose(std::span(room).first(size).subspan(kHeaderBytes));
  ASSERT_TRUE(pose.ok());
  EXPECT_EQ(pose->stamp.ns, 21);
  EXPECT_EQ(pose->pose.y_m, -2.5);

  size = write_end({1, 2, 3, 4, 5, 6, "why"}, room);
  const auto end = read_end(std::span(room).first(size).subspan(kHeaderBytes));
  ASSERT_TRUE(end.ok());
  EXPECT_EQ(end->frames, 1u);
  EXPECT_EQ(end->frames_dropped, 2u);
  EXPECT_EQ(end->poses_dropped, 6u);
  EXPECT_EQ(end->why, "why");
}

TEST(TapWire, HeadersOfStrangersAreRefused) {
  std::array<std::uint8_t, kHeaderBytes> bytes = {0, 0, 0, 0, 2};
  EXPECT_TRUE(read_header(bytes).ok());
  bytes[4] = 0;
  EXPECT_FALSE(read_header(bytes).ok());
  bytes[4] = 7;
  EXPECT_FALSE(read_header(bytes).ok());
  bytes = {0xFF, 0xFF, 0xFF, 0xFF, 2};
  EXPECT_FALSE(read_header(bytes).ok());
  for (const MessageType small :
       {MessageType::kCan, MessageType::kPose, MessageType::kEnd, MessageType::kBusy}) {
    bytes = {0, 0, 0, 1, static_cast<std::uint8_t>(small)};  // 16 MB
    EXPECT_FALSE(read_header(bytes).ok()) << "memory for a message that is never so long";
  }
}

}  // namespace
}  // namespace zenith::tap
