#include "drivers/odometry/dbc.h"

#include <string>
#include <utility>

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
BA_DEF_ BO_ "Cycle" INT 0 1000;
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
                                       HasSubstr("15 more malformed statements")));
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
  EXPECT_THAT(parse_error("\xFF\x01 hello\n"),
              HasSubstr("x.dbc:1: expected a statement of the DBC format (BO_, SG_, CM_, ...), "
                        "found '\\xff\\x01 hello'"));
  const auto missing = load_dbc("/no/such/file.dbc");
  ASSERT_FALSE(missing.ok());
  EXPECT_THAT(missing.error().message, HasSubstr("/no/such/file.dbc: missing or cannot be opened"));
  const auto folder = load_dbc("/");
  ASSERT_FALSE(folder.ok());
  EXPECT_THAT(folder.error().message, HasSubstr("cannot be read"));
}

constexpr const char* kHead =
    "VERSION \"\"\nBO_ 512 WHEELS: 8 BASE\n"
    " SG_ LEFT : 0|32@1- (1,0) [0|0] \"m\" ROBOT\n"
    " SG_ RIGHT : 32|32@1- (1,0) [0|0] \"m\" ROBOT\n\n";
constexpr const char* kTail = "SIG_VALTYPE_ 512 LEFT : 1;\nSIG_VALTYPE_ 512 RIGHT : 1;\n";

// Whatever stands before the types, they are read, or an error says what was not.
TEST(Dbc, AQuoteInATextIsOnlyACharacter) {
  for (const char* text : {
           "CM_ SG_ 512 LEFT \"travel of the 6\\\" wheel on the left\";\n",
           "CM_ SG_ 512 LEFT \"travel of the 6\" wheel on the left\";\n",
           "CM_ \"6\\\" and 8\\\"\";\nCM_ BO_ 512 \"one \" alone\";\n",
           "CM_ \"\";\nCM_ \"\\\"\";\n",
           "CM_ BO_ 512 \"over\nmore \\\" lines,\n\n one \" each\";\r\n",
           "CM_ \"SIG_VALTYPE_ 512 LEFT : 0;\nSIG_VALTYPE_ 512 LEFT : 0;\n\";\n",
           "CM_ \"a semicolon; or \\\"; two\";\n",
           "CM_\n  SG_ 512\n LEFT\n\"spread\"\n ;\n",
           "BA_DEF_ \"BusType\" STRING ;\nBA_DEF_DEF_ \"BusType\" \"a 6\" one\";\n",
           "BA_DEF_ BO_ \"E\" ENUM \"6\\\"\",\"7\" or so\",\"8\";\n",
           "BA_ \"Path\" \"C:\\logs\\\";\nBA_ \"Path\" BO_ 512 \"C:\\\";\n",
           "BA_ \"N\" SG_ 512 LEFT 17;\nBA_ \"F\" -1.5e3;\n",
           "VAL_ 512 LEFT 0 \"6\\\" wheel\" 1 \"7\" wheel\" -2 \"x;y\" ;\n",
           "VAL_TABLE_ T 1 \"over\nlines\" 0 \"none\" ;\nVAL_ ENV 1 \"a\" ;\n",
           "BA_DEF_REL_ BU_SG_REL_ \"R\" INT 0 65535;\nBA_REL_ \"R\" BU_SG_REL_ B SG_ 512 LEFT "
           "1;\n",
           "EV_ E: 0 [0|1] \"unit\" 0 2 DUMMY_NODE_VECTOR0 Vector__XXX;\nENVVAR_DATA_ E: 5;\n",
           "SIG_GROUP_ 512 G 1 : LEFT RIGHT;\nBO_TX_BU_ 512 : A,B;\nSGTYPE_ 1;\n",
           "CM_ \"Gr\xF6\xDF"
           "e in \xB0\";\n",
       }) {
    const std::string whole = std::string(kHead) + text + kTail;
    const auto file = parse_dbc(whole, "x.dbc");
    ASSERT_TRUE(file.ok()) << text << file.error().message;
    for (const DbcEntry& entry : file->signals) {
      EXPECT_EQ(entry.signal.value, DbcValue::kFloat32) << text;
    }
    std::string crlf;
    for (const char c : whole) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
    const auto other = parse_dbc(crlf, "x.dbc");
    ASSERT_TRUE(other.ok()) << text << other.error().message;
    EXPECT_EQ(other->signals[1].signal, file->signals[1].signal);
  }
}

TEST(Dbc, NothingIsPassedOverInSilence) {
  const std::pair<const char*, const char*> cases[] = {
      {"CM_ SG_ 512 LEFT \"no end;\n", "x.dbc:6: a text of CM_ has no end"},
      {"CM_ \"no end;\nCM_ \"an end\";\n", "x.dbc:6: a text of CM_ has no end, or holds a quote"},
      {"FOO_ 1 2;\n", "x.dbc:6: expected a statement of the DBC format"},
      {"CM_ \"good\" 5;\nBO_\n", "x.dbc:6: a text of CM_"},
      {"BA_ \"A\" 5\nCM_ \"x\";\n", "x.dbc:6: expected ';' at the end of BA_"},
      {"CM_ \"x\"\nCM_ \"y\";\n", "x.dbc:6: expected ';' at the end of CM_"},
      {"VAL_ 512 LEFT 0 \"x\n", "x.dbc:6: a text of VAL_"},
      {"BU_ A B\n", "x.dbc:6: expected the nodes"},
      {"SG_MUL_VAL_ 512 LEFT M 3;\n", "x.dbc:6: expected a multiplexed signal"},
      {"SG_MUL_VAL_ 512 LEFT M 3-1;\n", "x.dbc:6: expected a multiplexed signal"},
      {"SG_MUL_VAL_ 512 NONE M 3-4;\n", "x.dbc:6: speaks of the signal NONE of message 512"},
      {"SIG_VALTYPE_ 512 LEFT : 1\n", "x.dbc:6: expected a type"},
      {"BO_ 513 X: 8 B stray\n", "x.dbc:6: expected a statement"},
      {" SG_ Y : 0|8@1+ (1,0) [0|0] \"a\nb\" R\n", "x.dbc:6: expected a signal"},
  };
  for (const auto& [text, expected] : cases) {
    EXPECT_THAT(parse_error(std::string(kHead) + text + kTail), HasSubstr(expected)) << text;
  }
}

TEST(Dbc, TheListOfSymbolsEndsWhereStatementsBegin) {
  for (const char* symbols : {"NS_ :\n\tCM_\n\tBA_DEF_\n\tFILTER\n\tSIG_VALTYPE_\n\n",
                              "NS_ : CM_ BA_\n", "NS_:\n", "NS_ :\n\tNS_DESC_\nBS_: 500:1,2\n"}) {
    const auto file = parse_dbc(std::string(symbols) + kHead + kTail, "x.dbc");
    ASSERT_TRUE(file.ok()) << symbols << file.error().message;
    EXPECT_EQ(file->signals[0].signal.value, DbcValue::kFloat32);
  }
}

constexpr const char* kPages =
    "BO_ 2147483920 PAGES: 8 BASE\n"
    " SG_ PAGE M : 0|4@1+ (1,0) [0|0] \"\" R\n"
    " SG_ SUB m1M : 4|4@1+ (1,0) [0|0] \"\" R\n"
    " SG_ SPEED m0 : 8|16@1- (0.001,0) [0|0] \"m/s\" R\n"
    " SG_ DEEP m3 : 8|16@1+ (1,0) [0|0] \"\" R\n"
    " SG_ ALWAYS : 56|8@1+ (1,0) [0|0] \"\" R\n"
    " SG_ LOST m2M : 40|4@1+ (1,0) [0|0] \"\" R\n"
    "SG_MUL_VAL_ 2147483920 DEEP SUB 3-5, 9-9;\n"
    "SG_MUL_VAL_ 2147483920 SUB PAGE 1-1;\n"
    "SG_MUL_VAL_ 2147483920 LOST NONE 1-1;\n";

bool is_in(const char* name, std::uint8_t first_byte) {
  const auto file = parse_dbc(kPages, "x.dbc");
  EXPECT_TRUE(file.ok()) << file.error().message;
  const auto entry = find_signal(*file, name);
  EXPECT_TRUE(entry.ok()) << entry.error().message;
  CanFrame frame;
  frame.length = 8;
  frame.data[0] = first_byte;
  return holds(entry->conditions, frame);
}

TEST(Dbc, MultiplexedSignalsAreInTheirFramesAlone) {
  for (int page = 0; page < 16; ++page) {
    for (int sub = 0; sub < 16; ++sub) {
      const auto byte = static_cast<std::uint8_t>(page | sub << 4);
      EXPECT_TRUE(is_in("PAGE", byte) && is_in("ALWAYS", byte));
      EXPECT_EQ(is_in("SPEED", byte), page == 0);
      EXPECT_EQ(is_in("SUB", byte), page == 1);
      EXPECT_EQ(is_in("DEEP", byte), page == 1 && ((sub >= 3 && sub <= 5) || sub == 9));
    }
  }
  const auto file = parse_dbc(kPages, "x.dbc");
  EXPECT_THAT(find_signal(*file, "LOST").error().message,
              AllOf(HasSubstr("is multiplexed (m2M)"), HasSubstr("no selector NONE")));
  const auto two = parse_dbc(std::string(kPages) +
                                 "BO_ 1 X: 8 B\n SG_ A M : 0|4@1+ (1,0) [0|0] "
                                 "\"\" R\n SG_ B M : 4|4@1+ (1,0) [0|0] \"\" R\n SG_ C m1 : 8|8@1+ "
                                 "(1,0) [0|0] \"\" R\n",
                             "x.dbc");
  ASSERT_TRUE(two.ok()) << two.error().message;
  EXPECT_THAT(find_signal(*two, "C").error().message, HasSubstr("exactly one selector (M)"));
  // Each selects the other.
  const auto circle = parse_dbc(
      "BO_ 1 X: 8 B\n SG_ A m1M : 0|4@1+ (1,0) [0|0] \"\" R\n SG_ B m2M : 4|4@1+ (1,0) [0|0] \"\" "
      "R\nSG_MUL_VAL_ 1 A B 1-1;\nSG_MUL_VAL_ 1 B A 2-2;\n",
      "x.dbc");
  ASSERT_TRUE(circle.ok()) << circle.error().message;
  EXPECT_THAT(find_signal(*circle, "A").error().message, HasSubstr("selectors in a row"));
}

// Every beginning of a file is either parsed or refused; nothing is read beyond it.
TEST(Dbc, SurvivesEveryTruncation) {
  const std::string text = kFile;
  int parsed_count = 0;
  for (std::size_t length = 0; length < text.size(); ++length) {
    const std::string part = text.substr(0, length);
    parsed_count += parse_dbc(std::string_view(part), "x.dbc").ok() ? 1 : 0;
  }
  EXPECT_GT(parsed_count, 50);
}

}  // namespace
}  // namespace zenith
