// Whether what a codec reads can be wheels: simulated bases, read rightly and wrongly.

#include "drivers/odometry/wheel_watch.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/odometry/dbc_codec.h"
#include "drivers/odometry/wheel_decoder.h"
#include "platform/base/random.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

using testing::HasSubstr;

struct Speeds {
  double left_mps = 0.0;
  double right_mps = 0.0;
  double seconds = 0.0;
};

// What a robot does: forward, curves, on the spot, backward, standing.
const std::vector<Speeds> kDrive = {{0.5, 0.5, 8.0},   {0.5, 0.4, 5.0},   {0.3, -0.3, 4.0},
                                    {0.0, 0.0, 5.0},   {-0.4, -0.4, 5.0}, {-0.2, 0.3, 4.0},
                                    {0.45, 0.55, 8.0}, {0.0, 0.0, 2.0},   {0.6, 0.6, 10.0}};

// A base whose two signals are as `sent`, read by a codec that takes them as `read`.
struct Base {
  DbcSignal left = {.id = {0x200}, .bit_length = 32, .value = DbcValue::kSigned, .scale = 0.001};
  DbcSignal right = {
      .id = {0x200}, .start_bit = 32, .bit_length = 32, .value = DbcValue::kSigned, .scale = 0.001};
  WheelQuantity quantity = WheelQuantity::kPosition;
};

// The positions of a base may wrap within a wider signal.
WheelFault drive(const std::vector<Speeds>& plan, const Base& sent, const Base& read,
                 std::uint64_t wrap = 0, double start_m = 0.0) {
  const TestSeed seed;
  Random random(seed.value());
  WheelLimits limits;
  const dbc::Codec codec = {read.left, read.right, read.quantity, 1.0, {}, {}};
  WheelDecoder decoder(codec, codec.scales({}), limits);
  double left_m = start_m;
  double right_m = start_m;
  Time stamp = {1'000'000'000};
  for (const Speeds& part : plan) {
    for (int i = 0; i < static_cast<int>(part.seconds * 50.0); ++i) {
      const double left = part.left_mps * (part.left_mps != 0.0 ? random.uniform(0.9, 1.1) : 1.0);
      const double right =
          part.right_mps * (part.right_mps != 0.0 ? random.uniform(0.9, 1.1) : 1.0);
      left_m += 0.02 * left;
      right_m += 0.02 * right;
      stamp = stamp + Duration{20'000'000};
      CanFrame frame;
      const bool position = sent.quantity == WheelQuantity::kPosition;
      const auto put = [&](const DbcSignal& signal, double value) {
        std::uint64_t raw = raw_of(signal, value);
        if (position) raw = static_cast<std::uint64_t>(std::llround(value / signal.scale));
        if (wrap > 0) raw %= wrap;
        frame.id = signal.id.id;
        frame.length = 8;
        write_raw(signal, raw, frame);
      };
      put(sent.left, position ? left_m : left);
      put(sent.right, position ? right_m : right);
      frame.stamp = stamp;
      (void)decoder.decode(frame);
    }
  }
  return decoder.fault();
}

DbcSignal as(DbcSignal signal, std::uint32_t start, std::uint32_t length, bool motorola,
             DbcValue value = DbcValue::kSigned) {
  signal.start_bit = start;
  signal.bit_length = length;
  signal.motorola = motorola;
  signal.value = value;
  return signal;
}

TEST(WheelWatch, WheelsThatAreReadRightAreLeftAlone) {
  EXPECT_EQ(drive(kDrive, {}, {}).kind, WheelFaultKind::kNone);
  Base velocity;
  velocity.quantity = WheelQuantity::kVelocity;
  EXPECT_EQ(drive(kDrive, velocity, velocity).kind, WheelFaultKind::kNone);
  // The same in 16 bits, which wrap several times.
  Base narrow;
  narrow.left = as(narrow.left, 0, 12, false, DbcValue::kUnsigned);
  narrow.right = as(narrow.right, 32, 12, false, DbcValue::kUnsigned);
  EXPECT_EQ(drive(kDrive, narrow, narrow, 4096, 0.1).kind, WheelFaultKind::kNone);
}

// Two turns about one wheel that stands, of a base that is 40 cm wide; then the other one.
TEST(WheelWatch, TurningAboutOneWheelIsNoFault) {
  const std::vector<Speeds> pivots = {{0.0, 0.5, 10.0}, {-0.5, 0.0, 10.0}, {0.3, 0.3, 5.0}};
  EXPECT_EQ(drive({pivots[0]}, {}, {}).kind, WheelFaultKind::kNone);
  EXPECT_EQ(drive(pivots, {}, {}).kind, WheelFaultKind::kNone);
  // After it has moved once, for as long as one likes.
  EXPECT_EQ(drive({{0.3, 0.3, 1.0}, {0.0, 0.5, 60.0}}, {}, {}).kind, WheelFaultKind::kNone);
}

TEST(WheelWatch, BackwardAndStandingAreNoFaults) {
  EXPECT_EQ(drive({{-0.5, -0.5, 30.0}}, {}, {}).kind, WheelFaultKind::kNone);
  EXPECT_EQ(drive({{0.0, 0.0, 30.0}}, {}, {}).kind, WheelFaultKind::kNone);
}

TEST(WheelWatch, AWrongByteOrderIsNonsense) {
  Base wrong;
  wrong.left = as(wrong.left, 7, 32, true);
  wrong.right = as(wrong.right, 39, 32, true);
  const WheelFault fault = drive(kDrive, {}, wrong);
  EXPECT_EQ(fault.kind, WheelFaultKind::kNonsense);
  EXPECT_GT(fault.share, 0.3);
  EXPECT_THAT(wheel_fault_text(fault), HasSubstr("byte order, width and sign"));
  Base motorola;
  motorola.left = as(motorola.left, 7, 32, true);
  motorola.right = as(motorola.right, 39, 32, true);
  EXPECT_EQ(drive(kDrive, motorola, motorola).kind, WheelFaultKind::kNone);
  EXPECT_EQ(drive(kDrive, motorola, {}).kind, WheelFaultKind::kNonsense);
  // 16 bits of each, swapped.
  Base narrow;
  narrow.left = as(narrow.left, 7, 16, true);
  narrow.right = as(narrow.right, 39, 16, true);
  EXPECT_EQ(drive(kDrive, {}, narrow).kind, WheelFaultKind::kNonsense);
}

TEST(WheelWatch, AWrongWidthIsNonsenseOrAWheelThatStands) {
  Base beside;  // over the border between both
  beside.left = as(beside.left, 16, 32, false);
  EXPECT_EQ(drive(kDrive, {}, beside).kind, WheelFaultKind::kNonsense);
  Base high;  // the upper half of one wheel
  high.left = as(high.left, 16, 16, false);
  const WheelFault fault = drive({{0.5, 0.5, 30.0}}, {}, high);
  EXPECT_EQ(fault.kind, WheelFaultKind::kLeftStands);
  EXPECT_THAT(wheel_fault_text(fault), HasSubstr("the left wheel never moved while the right"));
  Base other;  // a signal that is something else's
  other.right = as(other.right, 60, 4, false, DbcValue::kUnsigned);
  other.right.id = {0x200};
  EXPECT_EQ(drive({{0.5, 0.5, 30.0}}, {}, other).kind, WheelFaultKind::kRightStands);
  Base all;  // 64 bits of both
  all.left = as(all.left, 0, 64, false);
  EXPECT_EQ(drive(kDrive, {}, all).kind, WheelFaultKind::kNonsense);
}

TEST(WheelWatch, AnotherWrapIsToldWithItsSize) {
  Base sent;
  sent.left = as(sent.left, 0, 32, false, DbcValue::kUnsigned);
  sent.right = as(sent.right, 32, 32, false, DbcValue::kUnsigned);
  for (const int bits : {10, 12}) {
    // 1 and 4 m to a wrap.
    const WheelFault fault = drive({{0.5, 0.5, 40.0}}, sent, {}, std::uint64_t{1} << bits, 0.3);
    EXPECT_EQ(fault.kind, WheelFaultKind::kWraps) << bits;
    EXPECT_THAT(wheel_fault_text(fault), HasSubstr("at " + std::to_string(bits) + " bits"));
  }
  EXPECT_EQ(drive({{0.5, 0.5, 300.0}}, sent, {}, 1 << 16, 0.3).kind, WheelFaultKind::kWraps);
}

TEST(WheelWatch, VelocitiesWithoutTheirSignAreNonsense) {
  Base sent;
  sent.quantity = WheelQuantity::kVelocity;
  sent.left = as(sent.left, 0, 16, false);
  sent.right = as(sent.right, 16, 16, false);
  Base read = sent;
  EXPECT_EQ(drive(kDrive, sent, read).kind, WheelFaultKind::kNone);
  read.left.value = read.right.value = DbcValue::kUnsigned;
  EXPECT_EQ(drive({{0.5, 0.5, 10.0}, {-0.4, -0.4, 5.0}}, sent, read).kind,
            WheelFaultKind::kNonsense);
  Base swapped = sent;
  swapped.left = as(swapped.left, 7, 16, true);
  swapped.right = as(swapped.right, 23, 16, true);
  EXPECT_EQ(drive(kDrive, sent, swapped).kind, WheelFaultKind::kNonsense);
}

TEST(WheelWatch, ABaseThatRestartsIsNoFault) {
  WheelDecoder decoder;
  Time stamp = {1'000'000'000};
  const auto send = [&](int left, int right) {
    stamp = stamp + Duration{20'000'000};
    CanFrame frame = agilex_v2::encode_odometer(stamp, {left, right});
    (void)decoder.decode(frame);
  };
  for (int restart = 0; restart < 6; ++restart) {
    for (int i = 0; i < 500; ++i) send(10 * i, 10 * i);
    stamp = stamp + Duration{3'000'000'000};
  }
  EXPECT_EQ(decoder.counters().resets, 5U);
  EXPECT_EQ(decoder.fault().kind, WheelFaultKind::kNone);
}

TEST(WheelWatch, SaysNothingOfNothing) {
  EXPECT_EQ(WheelWatch().fault().kind, WheelFaultKind::kNone);
  EXPECT_EQ(wheel_fault_text({}), "");
}

}  // namespace
}  // namespace zenith
