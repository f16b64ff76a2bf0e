#include "drivers/odometry/dbc.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kFile = R"(VERSION ""

NS_ :
    CM_
    SIG_VALTYPE_
    SG_MUL_VAL_

BU_: BASE PC

BO_ 170 WHEELS: 8 BASE
 SG_ LEFT : 6|15@0+ (0.01,-67.67) [0|250] "km/h" PC
 SG_ RIGHT : 22|15@0+ (1E-2,-67.67) [0|250] "km/h" PC,BASE
 SG_ FLAG: 7|1@0+(1,0)[0|0]"" PC

BO_ 2566855178 POSITIONS: 8 BASE
 SG_ LEFT : 0|32@1- (0.001,0) [0|0] "m" PC
 SG_ RIGHT_F : 32|32@1- (1,0) [-1e6|+1e6] "turns" PC

BO_ 300 MIXED: 8 BASE
 SG_ SELECTOR M : 0|8@1+ (1,0) [0|0] "" PC
 SG_ SPEED m3 : 8|16@1+ (1,0) [0|0] "" PC

BO_ 301 ODD: 4 BASE
 SG_ TOO_FAR : 24|16@1+ (1,0) [0|0] "" PC
 SG_ HALF : 0|16@1- (1,0) [0|0] "" PC
 SG_ FLAT : 0|16@1- (0,5) [0|0] "" PC
 SG_ LONG : 0|65@1- (1,0) [0|0] "" PC
 SG_ NONE : 0|0@1- (1,0) [0|0] "" PC
 SG_ OUT : 4000000000|8@0- (1,0) [0|0] "" PC

BO_ 2048 WRONG_ID: 8 BASE
 SG_ LOST : 0|16@1- (1,0) [0|0] "" PC

CM_ SG_ 170 LEFT "A comment over lines
BO_ 1 TRAP: what
 SG_ TRAP
 ends here";
VAL_ 170 FLAG 1 "bad" 0 "good" ;
SIG_VALTYPE_ 2566855178 RIGHT_F : 1;
SIG_VALTYPE_ 301 HALF 1;
)";

DbcFile parsed() {
  auto file = parse_dbc(kFile, "base.dbc");
  if (!file.ok()) {
    ADD_FAILURE() << file.error().message;
    return {};
  }
  return *file;
}

TEST(Dbc, FindsSignalsWithAllTheirParts) {
  const DbcFile file = parsed();
  const auto right = find_signal(file, "RIGHT");
  ASSERT_TRUE(right.ok()) << right.error().message;
  EXPECT_EQ(right->signal, (DbcSignal{.id = {170},
                                      .start_bit = 22,
                                      .bit_length = 15,
                                      .motorola = true,
                                      .scale = 0.01,
                                      .offset = -67.67}));
  EXPECT_EQ(right->unit, "km/h");
  EXPECT_EQ(right->message, "WHEELS");
  EXPECT_EQ(right->line, 12);
  EXPECT_TRUE(find_signal(file, "FLAG").ok());
  EXPECT_TRUE(find_signal(file, "SELECTOR").ok());
}

TEST(Dbc, KnowsLongIdentifiersSignsAndFloats) {
  const DbcFile file = parsed();
  const auto left = find_signal(file, "POSITIONS.LEFT");
  ASSERT_TRUE(left.ok()) << left.error().message;
  EXPECT_EQ(left->signal.id, (CanId{0x18FF1A0A, true}));
  EXPECT_EQ(left->signal.value, DbcValue::kSigned);
  EXPECT_FALSE(left->signal.motorola);
  const auto turns = find_signal(file, "RIGHT_F");
  ASSERT_TRUE(turns.ok()) << turns.error().message;
  EXPECT_EQ(turns->signal.value, DbcValue::kFloat32);
}

std::string refusal(const char* name) {
  const auto found = find_signal(parsed(), name);
  return found.ok() ? "found" : found.error().message;
}

TEST(Dbc, SaysWhyASignalCannotBeUsed) {
  EXPECT_THAT(refusal("SPEED"), AllOf(HasSubstr("base.dbc:21: the signal MIXED.SPEED"),
                                      HasSubstr("is multiplexed (m3)")));
  EXPECT_THAT(refusal("LEFT"),
              AllOf(HasSubstr("WHEELS (line 11)"), HasSubstr("POSITIONS (line 16)"),
                    HasSubstr("MESSAGE.SIGNAL")));
  EXPECT_THAT(refusal("ODD.LEFT"), HasSubstr("has no signal 'ODD.LEFT'"));
  EXPECT_THAT(refusal("LEFTT"), HasSubstr("has no signal 'LEFTT'"));
  EXPECT_THAT(refusal("TOO_FAR"), HasSubstr("does not fit into the 4 bytes"));
  EXPECT_THAT(refusal("OUT"), HasSubstr("does not fit"));
  EXPECT_THAT(refusal("HALF"), HasSubstr("is a float of 16 bits"));
  EXPECT_THAT(refusal("FLAT"), HasSubstr("scale"));
  EXPECT_THAT(refusal("LONG"), HasSubstr("has 65 bits"));
  EXPECT_THAT(refusal("NONE"), HasSubstr("has 0 bits"));
  EXPECT_THAT(refusal("LOST"), HasSubstr("2048"));
}

std::string parse_error(const std::string& text) {
  const auto file = parse_dbc(text, "x.dbc");
  return file.ok() ? "parsed" : file.error().message;
}

TEST(Dbc, TellsAllMalformedLinesAtOnce) {
  const std::string message = parse_error(
      "BO_ 170 WHEELS 8 BASE\n"
      " SG_ ORPHAN : 0|8@1+ (1,0) [0|0] \"\" PC\n"
      "BO_ 171 WHEELS: 8 BASE\r\n"
      " SG_ A : 0|8@2+ (1,0) [0|0] \"\" PC\n"
      " SG_ B : 0,8@1+ (1,0) [0|0] \"\" PC\n"
      " SG_ C : 0|8@1* (1,0) [0|0] \"\" PC\n"
      " SG_ D : 0|8@1+ (1;0) [0|0] \"\" PC\n"
      " SG_ E : 0|8@1+ (1,0) [0|0] km PC\n"
      " SG_ F mx : 0|8@1+ (1,0) [0|0] \"\" PC\n"
      " SG_ OK : 0|8@1+ (1,0) [0|0] \"\" PC\r\n"
      "SIG_VALTYPE_ 171 MISSING : 1;\n"
      "SIG_VALTYPE_ 171 OK : 7;\n");
  for (const int line : {1, 2, 4, 5, 6, 7, 8, 9, 11, 12}) {
    EXPECT_THAT(message, HasSubstr("x.dbc:" + std::to_string(line) + ": "));
  }
  EXPECT_THAT(message, Not(HasSubstr("x.dbc:10:")));
  EXPECT_THAT(message, HasSubstr("x.dbc:2: the signal ORPHAN stands in no message"));
}

TEST(Dbc, LimitsTheListOfProblems) {
  std::string text;
  for (int i = 0; i < 25; ++i) text += "BO_ x\n";
  EXPECT_THAT(parse_error(text), AllOf(HasSubstr("x.dbc:10:"), Not(HasSubstr("x.dbc:11:")),
                                       HasSubstr("15 more malformed lines")));
}

TEST(Dbc, AnEditorsMarkIsPassedOver) {
  const tools::TemporaryFolder folder;
  const std::string path = (folder.path() / "base.dbc").string();
  tools::write_text(path, std::string("\xef\xbb\xbf") + kFile);
  const auto file = load_dbc(path);
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(file->signals.size(), parse_dbc(kFile, path)->signals.size());
}

TEST(Dbc, RefusesFilesThatAreNone) {
  EXPECT_THAT(parse_error(""), HasSubstr("holds no signal"));
  EXPECT_THAT(parse_error("\xFF\x00\x01 hello\n"), HasSubstr("holds no signal"));
  const auto missing = load_dbc("/no/such/file.dbc");
  ASSERT_FALSE(missing.ok());
  EXPECT_THAT(missing.error().message, HasSubstr("/no/such/file.dbc: missing or cannot be opened"));
  const auto folder = load_dbc("/");
  ASSERT_FALSE(folder.ok());
  EXPECT_THAT(folder.error().message, HasSubstr("cannot be read"));
}

// Every beginning of a file is either parsed or refused; nothing is read beyond it.
TEST(Dbc, SurvivesEveryTruncation) {
  const std::string text = kFile;
  int parsed_count = 0;
  for (std::size_t length = 0; length < text.size(); ++length) {
    const std::string part = text.substr(0, length);
    parsed_count += parse_dbc(std::string_view(part), "x.dbc").ok() ? 1 : 0;
  }
  EXPECT_GT(parsed_count, 100);
}

}  // namespace
}  // namespace zenith
