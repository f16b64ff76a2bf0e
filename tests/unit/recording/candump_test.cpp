#include "platform/recording/candump.h"

#include <array>
#include <utility>

#include <gtest/gtest.h>

#include "platform/recording/seconds.h"

namespace zenith::tools {
namespace {

TEST(Candump, ReadsALineOfCandump) {
  const CandumpRecord record = parse_candump("(1436509052.249713) can0 311#0000002A0000002B");
  ASSERT_EQ(record.line, CandumpLine::kFrame);
  const CanFrame& frame = record.frame;
  EXPECT_EQ(frame.stamp.ns, 1436509052249713000);
  EXPECT_EQ(record.interface, "can0");
  EXPECT_EQ(frame.id, 0x311U);
  EXPECT_FALSE(frame.extended);
  EXPECT_EQ(frame.length, 8);
  EXPECT_EQ(frame.data[3], 0x2A);
  EXPECT_EQ(frame.data[7], 0x2B);
}

TEST(Candump, KnowsExtendedShortAndDirectedFrames) {
  CandumpRecord record = parse_candump("(12.5) vcan1 0000091B#0011 R\r");
  ASSERT_EQ(record.line, CandumpLine::kFrame);
  EXPECT_TRUE(record.frame.extended);
  EXPECT_EQ(record.frame.id, 0x91BU);
  EXPECT_EQ(record.frame.length, 2);
  EXPECT_EQ(record.frame.stamp.ns, 12500000000);
  record = parse_candump("(12.5) can0 7FF#");
  EXPECT_EQ(record.line, CandumpLine::kFrame);
  EXPECT_EQ(record.frame.length, 0);
}

// One and the same frame, as each form of candump writes it.
TEST(Candump, ReadsAllForms) {
  struct Form {
    const char* line;
    CandumpStamp stamp;
    const char* interface;
  };
  const Form forms[] = {
      {"(1436509052.249713) can0 311#0000002A0000002B", CandumpStamp::kSeconds, "can0"},
      {"(1436509052.249713123)  can0 311#0000002a0000002b", CandumpStamp::kSeconds, "can0"},
      {"(1436509052.249713) 311#0000002A0000002B", CandumpStamp::kSeconds, ""},
      {"(1436509052.249713) can0 311#0000002A0000002B T", CandumpStamp::kSeconds, "can0"},
      {"(1436509052.249713) can0 311#0000002A0000002B R - -", CandumpStamp::kSeconds, "can0"},
      {"(1436509052.249713) can0 311#0000002A0000002B_B", CandumpStamp::kSeconds, "can0"},
      {"(2015-07-10 06:17:32.249713) can0 311#0000002A0000002B", CandumpStamp::kLocalDate, "can0"},
      {"(004.249713) can0 311#0000002A0000002B", CandumpStamp::kFewSeconds, "can0"},
      {" (1436509052.249713)  can0  311   [8]  00 00 00 2A 00 00 00 2B", CandumpStamp::kSeconds,
       "can0"},
      {" (1436509052.249713)  can0  311   [8]  00 00 00 2A 00 00 00 2B   '...*...+'\r",
       CandumpStamp::kSeconds, "can0"},
      {" (1436509052.249713)  can0  RX - -  311   [8]  00 00 00 2A 00 00 00 2B",
       CandumpStamp::kSeconds, "can0"},
      {" (1436509052.249713)  can0  TX B E  311   [8]  00 00 00 2A 00 00 00 2B",
       CandumpStamp::kSeconds, "can0"},
      {" (1436509052.249713)  311   [8]  00 00 00 2A 00 00 00 2B", CandumpStamp::kSeconds, ""},
      {" (004.249713)  can0       311   [8]  00 00 00 2A 00 00 00 2B", CandumpStamp::kFewSeconds,
       "can0"},
      {" (2015-07-10 06:17:32.249713)  can0  311   [8]  00 00 00 2A 00 00 00 2B",
       CandumpStamp::kLocalDate, "can0"},
      {"  can0  311   [8]  00 00 00 2A 00 00 00 2B", CandumpStamp::kNone, "can0"},
      {"  311   [8]  00 00 00 2A 00 00 00 2B", CandumpStamp::kNone, ""},
      {"  can0  311   [8]  2B`00`00`00`2A`00`00`00", CandumpStamp::kNone, "can0"},
      {"  can0  311   [8]  2B`00`00`00`2A`00`00`00   `+...*...`", CandumpStamp::kNone, "can0"},
      {"  can0  311   {B}  00 00 00 2A 00 00 00 2B", CandumpStamp::kNone, "can0"},
      {"  can0  311   [8]  00000000 00000000 00000000 00101010 00000000 00000000 00000000 00101011",
       CandumpStamp::kNone, "can0"},
  };
  for (const Form& form : forms) {
    SCOPED_TRACE(form.line);
    const CandumpRecord record = parse_candump(form.line);
    ASSERT_EQ(record.line, CandumpLine::kFrame);
    EXPECT_EQ(record.stamp, form.stamp);
    EXPECT_EQ(record.interface, form.interface);
    EXPECT_EQ(record.frame.id, 0x311U);
    EXPECT_EQ(record.frame.length, 8);
    EXPECT_EQ(record.frame.data, (std::array<std::uint8_t, 8>{0, 0, 0, 0x2A, 0, 0, 0, 0x2B}));
    if (form.stamp == CandumpStamp::kSeconds || form.stamp == CandumpStamp::kLocalDate) {
      EXPECT_EQ(record.frame.stamp.ns / 1000, 1436509052249713);
    }
  }
  const CandumpRecord other = parse_candump("  can0  0000091B   [0]  ");
  EXPECT_EQ(other.line, CandumpLine::kFrame);
  EXPECT_TRUE(other.frame.extended);
  EXPECT_EQ(without_colours(" \x1b[1m(1.0)  can0\x1b[0m  311 \x1b[31;1m"), " (1.0)  can0  311 ");
  EXPECT_EQ(without_colours("\x1b["), "");
}

TEST(Candump, LeavesOtherFramesAlone) {
  const std::pair<const char*, CandumpLine> lines[] = {
      {"(1.0) can0 123#R", CandumpLine::kRemote},
      {"(1.0) can0 123#R4", CandumpLine::kRemote},
      {"  can0  123   [4]  remote request", CandumpLine::kRemote},
      {"(1.0) can0 123##1AABBCC", CandumpLine::kFd},
      {"  can0  123  [12]  00 11 22 33 44 55 66 77 88 99 AA BB", CandumpLine::kFd},
      {"  can0  123  [08]  00 11 22 33 44 55 66 77", CandumpLine::kFd},
      {"(1.0) can0 20000004#0004000000000000", CandumpLine::kError},
      {"  can0  20000004   [8]  00 04 00 00 00 00 00 00   ERRORFRAME", CandumpLine::kError},
      {"\tcontroller-problem{rx-overflow}", CandumpLine::kEmpty},
      {"", CandumpLine::kEmpty},
      {"   ", CandumpLine::kEmpty},
      {"DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 3)", CandumpLine::kDropped},
  };
  for (const auto& [line, kind] : lines) EXPECT_EQ(parse_candump(line).line, kind) << line;
}

TEST(Candump, RefusesWhatIsMalformed) {
  for (const char* line : {"(1.0) can0 311#123",
                           "(1.0) can0 311#00000000000000000",
                           "(1.0) can0 311",
                           "1.0 can0 311#00",
                           "(1.0 can0 311#00",
                           "() can0 311#00",
                           "(-1.0) can0 311#00",
                           "(1.x) can0 311#00",
                           "(1.0) can0 3111#00",
                           "(1.0) can0 FFF#00",
                           "(1.0) can0 GGG#00",
                           "(1.0) can0 311#0G",
                           "(1.0) can0 311#00 X",
                           "(1.0)",
                           "(nan) can0 311#00",
                           "(99999999999.0) can0 311#00",
                           "(1.0) can0 #00",
                           "\x01\xff(((",
                           "(1.0) can0 FFFFFFFF1#00",
                           "  can0  311   [8]  00 11",
                           "  can0  311   [2]  00 11 22",
                           "  can0  311   [9]  00 11 22 33 44 55 66 77 88",
                           "  can0  311   [x]  00",
                           "  can0  311   [2",
                           "  can0 x 311   [1]  00",
                           "  [1]  00",
                           "  can0  311   [2]  00`",
                           "  can0  311   [2]  00`11`22",
                           "  can0  311   []",
                           "(2015-13-10 06:17:32.2) can0 311#00",
                           "(2015-07-10) can0 311#00",
                           "(2015-07-10 06:17:32x5) can0 311#00"}) {
    EXPECT_EQ(parse_candump(line).line, CandumpLine::kMalformed) << line;
  }
}

TEST(Candump, WritesWhatItReads) {
  CanFrame frame;
  frame.stamp = {1436509052249713000};
  frame.id = 0x311;
  frame.length = 3;
  frame.data = {1, 0xAB, 0xFF};
  EXPECT_EQ(format_candump(frame, "can0"), "(1436509052.249713) can0 311#01ABFF");
  frame.extended = true;
  frame.stamp = {1000001000};
  EXPECT_EQ(format_candump(frame, "can0"), "(0000000001.000001) can0 00000311#01ABFF");
}

TEST(Seconds, AreExactToTheNanosecond) {
  EXPECT_EQ(parse_seconds("1436509052.249713123")->ns, 1436509052249713123);
  EXPECT_EQ(parse_seconds("0.5")->ns, 500000000);
  EXPECT_EQ(parse_seconds("7")->ns, 7000000000);
  EXPECT_FALSE(parse_seconds(""));
  EXPECT_FALSE(parse_seconds(".5"));
  EXPECT_EQ(parse_seconds("1.436509052249713123e+09")->ns, 1436509052249713123);
  EXPECT_EQ(parse_seconds("1e9")->ns, 1'000'000'000'000'000'000);
  EXPECT_EQ(parse_seconds("0.000000000000000000e+00")->ns, 0);
  EXPECT_EQ(parse_seconds("1.25e-01")->ns, 125'000'000);
  for (const char* text : {"1e", "1e+", "1e10", "9.1e9", "1e1.0", "e9", "1e-10", "9999999999e9"}) {
    EXPECT_FALSE(parse_seconds(text)) << text;
  }
  EXPECT_FALSE(parse_seconds("inf"));
  EXPECT_EQ(format_seconds({1436509052249713123}), "1436509052.249713123");
  EXPECT_EQ(format_seconds({5}), "0.000000005");
}

}  // namespace
}  // namespace zenith::tools
