// Logs of candump as people record them: whatever the form, the same frames on the recording's
// clock, or a reason.

#include "platform/recording/can_log.h"

#include <cstdio>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/odometry/agilex_v2.h"
#include "platform/recording/candump.h"

namespace zenith::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr Time kStart = {1'436'509'052'000'000'000};

// 200 frames, some 20 ms apart, that jitter as those of a bus do.
std::vector<CanFrame> drive() {
  std::vector<CanFrame> frames;
  for (int i = 0; i < 200; ++i) {
    const Time stamp = kStart + Duration{i * 20'000'000LL + (i * 7919 % 13) * 100'000LL * (i > 0)};
    frames.push_back(agilex_v2::encode_odometer(stamp, {10 * i, 11 * i}));
  }
  return frames;
}

std::string columns(const CanFrame& frame) {
  char text[64];
  std::snprintf(text, sizeof text, " can0  %03X   [%d] ", frame.id, frame.length);
  std::string line = text;
  for (int i = 0; i < frame.length; ++i) {
    std::snprintf(text, sizeof text, " %02X", frame.data[static_cast<std::size_t>(i)]);
    line += text;
  }
  return line;
}

std::string relative(Duration since) {
  char text[32];
  std::snprintf(text, sizeof text, "(%03lld.%06lld) ",
                static_cast<long long>(since.ns / 1'000'000'000),
                static_cast<long long>(since.ns % 1'000'000'000 / 1000));
  return text;
}

enum class Kind { kLog, kAbsolute, kZero, kDelta, kZeroLog, kDeltaLog, kDate, kNone };

std::string log_text(Kind kind, const char* end = "\n") {
  std::string text;
  Time last = kStart;
  for (const CanFrame& frame : drive()) {
    const std::string log = format_candump(frame, "can0");
    const std::string content = log.substr(log.find(')') + 2);
    const Duration zero = frame.stamp - kStart;
    const Duration delta = frame.stamp - last;
    char date[48];
    const long long us = frame.stamp.ns / 1000 - 1'436'509'052'000'000;
    std::snprintf(date, sizeof date, " (2015-07-10 06:17:%02lld.%06lld) ", 32 + us / 1'000'000,
                  us % 1'000'000);
    switch (kind) {
      case Kind::kLog:
        text += log;
        break;
      case Kind::kAbsolute:
        text += " " + log.substr(0, log.find(')') + 2) + columns(frame);
        break;
      case Kind::kZero:
        text += " " + relative(zero) + columns(frame);
        break;
      case Kind::kDelta:
        text += " " + relative(delta) + columns(frame);
        break;
      case Kind::kZeroLog:
        text += relative(zero) + content;
        break;
      case Kind::kDeltaLog:
        text += relative(delta) + content;
        break;
      case Kind::kDate:
        text += date + columns(frame);
        break;
      case Kind::kNone:
        text += " " + columns(frame);
        break;
    }
    text += end;
    last = frame.stamp;
  }
  return text;
}

Result<CanLog> read(const std::string& text, std::optional<Time> start = std::nullopt) {
  InputLines lines(text, "can0.log", {1 << 20});
  return parse_can_log(lines, "can0", start);
}

void expect_drive(const Result<CanLog>& log) {
  ASSERT_TRUE(log.ok()) << log.error().message;
  EXPECT_EQ(log->malformed, 0U) << log->first_malformed;
  const auto expected = drive();
  ASSERT_EQ(log->frames.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_EQ(log->frames[i].stamp, expected[i].stamp) << i;
    ASSERT_EQ(log->frames[i].data, expected[i].data) << i;
  }
}

TEST(CanLog, AbsoluteStampsAreTheRecordings) {
  for (const Kind kind : {Kind::kLog, Kind::kAbsolute, Kind::kDate}) {
    for (const char* end : {"\n", "\r\n"}) {
      const auto log = read(log_text(kind, end));
      expect_drive(log);
      EXPECT_EQ(log->local_dates, kind == Kind::kDate);
    }
  }
}

TEST(CanLog, RelativeStampsNeedTheirStart) {
  for (const Kind kind : {Kind::kZero, Kind::kDelta, Kind::kZeroLog, Kind::kDeltaLog}) {
    SCOPED_TRACE(static_cast<int>(kind));
    expect_drive(read(log_text(kind), kStart));
    const bool delta = kind == Kind::kDelta || kind == Kind::kDeltaLog;
    EXPECT_THAT(read(log_text(kind)).error().message,
                AllOf(HasSubstr("can0.log:1: "), HasSubstr(delta ? "-td" : "-tz"),
                      HasSubstr("odometry.log_start_s"), HasSubstr("record with candump -L")));
  }
}

// Stamps that never change are those of a bus with one message, each as long after the last.
TEST(CanLog, AConstantDeltaIsADelta) {
  std::string text = " (000.000000)  can0  123   [1]  00\n";
  for (int i = 0; i < 20; ++i) text += " (000.010000)  can0  123   [1]  00\n";
  const auto log = read(text, kStart);
  ASSERT_TRUE(log.ok()) << log.error().message;
  EXPECT_EQ(log->frames.back().stamp, kStart + Duration{200'000'000});
}

TEST(CanLog, WithoutStampsNothingCanBeSaid) {
  for (const auto& start : {std::optional<Time>(), std::optional<Time>(kStart)}) {
    EXPECT_THAT(read(log_text(Kind::kNone), start).error().message,
                AllOf(HasSubstr("no stamps"), HasSubstr("record with candump -L")));
  }
}

// Other programs' clocks may begin anywhere, and need no zeros in front.
TEST(CanLog, AClockThatBeginsAtZeroIsAClock) {
  const auto log = read(
      "(0.0) can0 123#00\n(0.5) can0 123#00\n(99.5) can0 123#00\n"
      "(100.5) can0 123#00\n");
  ASSERT_TRUE(log.ok()) << log.error().message;
  EXPECT_EQ(log->malformed, 0U);
  EXPECT_EQ(log->frames.back().stamp.ns, 100'500'000'000);
}

TEST(CanLog, AnyLogCanBePutOnAnotherClock) {
  const auto log = read(log_text(Kind::kLog), Time{7'000'000'000});
  ASSERT_TRUE(log.ok());
  EXPECT_EQ(log->frames[0].stamp.ns, 7'000'000'000);
  EXPECT_EQ((log->frames[9].stamp - log->frames[0].stamp).ns,
            (drive()[9].stamp - drive()[0].stamp).ns);
}

TEST(CanLog, CountsWhatIsNoFrameOfTheBase) {
  const auto log = read(
      "(1.0) can0 311#00\n(1.1) can1 311#00\n(1.2) can0 311#R\n(1.3) can0 311##100\n"
      "(1.4) can0 20000004#0004000000000000\nDROPCOUNT: dropped 1 CAN frame on 'can0' socket "
      "(total drops 1)\n\n(1.5) 311#00\n  can0  311   [1]  00\nnonsense\n"
      "\x1b[1m(1.6) can0 311#00\x1b[0m\n");
  ASSERT_TRUE(log.ok()) << log.error().message;
  EXPECT_EQ(log->frames.size(), 3U);
  EXPECT_EQ(log->other_interfaces, 1U);
  EXPECT_EQ(log->other_frames, 2U);
  EXPECT_EQ(log->fd_frames, 1U);
  EXPECT_EQ(log->drop_reports, 1U);
  EXPECT_EQ(log->malformed, 2U) << "a line without a stamp among those with one, and nonsense";
  EXPECT_EQ(log->first_malformed, "can0.log:9");
}

}  // namespace
}  // namespace zenith::tools
