#include "platform/base/printable.h"

#include <array>
#include <string>

#include <gtest/gtest.h>

namespace zenith {
namespace {

TEST(Printable, PlainTextStays) {
  for (const char* text : {"", "robot 1", "\\x1b", "K\u00fcche", "\u5eca\u4e0b", "\U0001F916"}) {
    EXPECT_EQ(printable(text), text);
    EXPECT_TRUE(is_printable(text)) << text;
  }
}

TEST(Printable, ControlCharactersAreShown) {
  EXPECT_EQ(printable("\x1b[2J\x1b]0;title\x07"), "\\x1b[2J\\x1b]0;title\\x07");
  EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("a\nb\tc\rd\x7f"), "a\\x0ab\\x09c\\x0dd\\x7f");
  EXPECT_EQ(printable("\u0080\u009b31m\u009f\u00a0"), "\\u0080\\u009b31m\\u009f\u00a0");
}

TEST(Printable, TextThatTurnsItsDirectionIsShown) {
  EXPECT_EQ(printable("gnp.\u202etxt\u202c"), "gnp.\\u202etxt\\u202c");
  EXPECT_EQ(printable("\u2066\u2067\u2068\u2069"), "\\u2066\\u2067\\u2068\\u2069");
  EXPECT_EQ(printable("\u2028\u2029\u202a\u202b\u202d"), "\\u2028\\u2029\\u202a\\u202b\\u202d");
  EXPECT_EQ(printable("\u2027\u202f\u2065\u206a"), "\u2027\u202f\u2065\u206a");
}

TEST(Printable, BytesThatAreNotUtf8AreShown) {
  EXPECT_EQ(printable("\x9b"
                      "31m"),
            "\\x9b31m");
  EXPECT_EQ(printable("\xc0\xaf"), "\\xc0\\xaf");                    // a long form of '/'
  EXPECT_EQ(printable("\xe0\x80\xaf"), "\\xe0\\x80\\xaf");           // another
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // a surrogate
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // above U+10FFFF
  EXPECT_EQ(printable("\xc3"), "\\xc3");                             // cut
  EXPECT_EQ(printable("\xe2\x80"), "\\xe2\\x80");
  EXPECT_EQ(printable("\xc3x\xff"), "\\xc3x\\xff");
}

// Whatever goes in, what comes out may go to a terminal and says the same when shown again.
TEST(Printable, EveryPairOfBytesComesOutPrintable) {
  for (int first = 0; first < 256; ++first) {
    for (int second = 0; second < 256; ++second) {
      const char pair[] = {static_cast<char>(first), static_cast<char>(second)};
      const std::string shown = printable({pair, 2});
      ASSERT_TRUE(is_printable(shown)) << first << " " << second;
      ASSERT_EQ(printable(shown), shown);
    }
  }
}

TEST(Printable, LineEndsMayStay) {
  EXPECT_EQ(printable("a\n\tb\x1b\r", LineEnds::kKeep), "a\n\tb\\x1b\\x0d");
}

TEST(Printable, LongTexts) {
  const std::string text(1000, '\x1b');
  EXPECT_EQ(printable(text).size(), 4000u);
  EXPECT_EQ(printable_start("short", 5), "short");
  EXPECT_EQ(printable_start("longer", 5), "lo...");
  EXPECT_EQ(printable_start("a\x1b\x1b", 9), "a\\x1b\\x1b");
  EXPECT_EQ(printable_start("a\x1b\x1b", 8), "a\\x1b...");
  EXPECT_EQ(printable_start("aa\u00e4\u00e4", 6), "aa\u00e4\u00e4");
  EXPECT_EQ(printable_start("aa\u00e4\u00e4", 5), "aa...");
  EXPECT_EQ(printable_start(std::string(100000, '\n'), 20), "\\x0a\\x0a\\x0a\\x0a...");
}

TEST(Printable, ABufferHoldsWholeCharacters) {
  std::array<char, 5> room = {};
  const PrintableSize size = write_printable("ab\x1b", room);
  EXPECT_EQ(size.read, 2u);
  EXPECT_EQ(size.written, 2u);
}

TEST(RobotName, IsShortAndPrintable) {
  EXPECT_TRUE(is_robot_name("a"));
  EXPECT_TRUE(is_robot_name(std::string(32, 'x')));
  EXPECT_TRUE(is_robot_name("\xF0\x9F\xA4\x96"));
  for (const char* wrong : {"", "a\nb", "a\x7F", "\xC2\x85", "\xC0\xAF", "\xED\xA0\x80", "\xC3x",
                            "\xFF", "\u202egnp", "r1\x1b[31m"}) {
    EXPECT_FALSE(is_robot_name(wrong)) << printable(wrong);
  }
  EXPECT_FALSE(is_robot_name(std::string(33, 'x')));
}

}  // namespace
}  // namespace zenith
