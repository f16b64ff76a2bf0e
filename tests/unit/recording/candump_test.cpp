#include "platform/recording/candump.h"

#include <gtest/gtest.h>

#include "platform/recording/seconds.h"

namespace zenith::tools {
namespace {

TEST(Candump, ReadsALineOfCandump) {
  CanFrame frame;
  std::string_view interface;
  ASSERT_EQ(parse_candump("(1436509052.249713) can0 311#0000002A0000002B", frame, interface),
            CandumpLine::kFrame);
  EXPECT_EQ(frame.stamp.ns, 1436509052249713000);
  EXPECT_EQ(interface, "can0");
  EXPECT_EQ(frame.id, 0x311U);
  EXPECT_FALSE(frame.extended);
  EXPECT_EQ(frame.length, 8);
  EXPECT_EQ(frame.data[3], 0x2A);
  EXPECT_EQ(frame.data[7], 0x2B);
}

TEST(Candump, KnowsExtendedShortAndDirectedFrames) {
  CanFrame frame;
  std::string_view interface;
  ASSERT_EQ(parse_candump("(12.5) vcan1 0000091B#0011 R\r", frame, interface), CandumpLine::kFrame);
  EXPECT_TRUE(frame.extended);
  EXPECT_EQ(frame.id, 0x91BU);
  EXPECT_EQ(frame.length, 2);
  EXPECT_EQ(frame.stamp.ns, 12500000000);
  EXPECT_EQ(parse_candump("(12.5) can0 7FF#", frame, interface), CandumpLine::kFrame);
  EXPECT_EQ(frame.length, 0);
}

TEST(Candump, LeavesOtherFramesAlone) {
  CanFrame frame;
  std::string_view interface;
  for (const char* line : {"(1.0) can0 123#R", "(1.0) can0 123#R4", "(1.0) can0 123##1AABBCC",
                           "(1.0) can0 20000004#0004000000000000", "", "   "}) {
    EXPECT_EQ(parse_candump(line, frame, interface), CandumpLine::kOther) << line;
  }
}

TEST(Candump, RefusesWhatIsMalformed) {
  CanFrame frame;
  std::string_view interface;
  for (const char* line :
       {"(1.0) can0 311#123", "(1.0) can0 311#00000000000000000", "(1.0) can0 311",
        "1.0 can0 311#00", "(1.0 can0 311#00", "() can0 311#00", "(-1.0) can0 311#00",
        "(1.x) can0 311#00", "(1.0) can0 3111#00", "(1.0) can0 FFF#00", "(1.0) can0 GGG#00",
        "(1.0) can0 311#0G", "(1.0) can0 311#00 X", "(1.0)", "(nan) can0 311#00",
        "(99999999999.0) can0 311#00", "(1.0) can0 #00", "\x01\xff(((",
        "(1.0) can0 FFFFFFFF1#00"}) {
    EXPECT_EQ(parse_candump(line, frame, interface), CandumpLine::kMalformed) << line;
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
