#include "platform/config/toml_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/config/setting.h"
#include "tests/support/hostile_files.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string repeated(const std::string& text, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

TEST(TomlText, KeysThatNestWithoutEndAreRefusedWithTheirLine) {
  const std::string deep = "a" + repeated(".a", 500'000);
  for (const std::string& text : {"x = 1\n" + deep + " = 1\n", "x = 1\n[" + deep + "]\n",
                                  "x = 1\n[[" + deep + "]]\n", "x = 1\ny = {" + deep + " = 1}\n",
                                  "x = 1\n" + repeated("'a' . \"b\" .", 50'000) + "c = 1\n"}) {
    const auto parsed = parse_toml(text);
    ASSERT_FALSE(parsed) << text.substr(0, 40);
    EXPECT_EQ(parsed.error().source().begin.line, 2u) << parsed.error().description();
  }
}

TEST(TomlText, HeadersWithoutANameAreRefusedWithTheirLine) {
  for (const char* header :
       {"[=]", "[\u00e9]", " [[.a]]", "[ ,", "[[]]", "[]", "[", "[ [a]]", "[[[a]]]", "[#"}) {
    const auto parsed = parse_toml("x = [\n[+1],\n  [{y = 1}]]\n" + std::string(header) + "\n");
    ASSERT_FALSE(parsed) << header;
    EXPECT_GE(parsed.error().source().begin.line, 4u) << header;
  }
  for (const char* header : {"[a]", "  [ a . b ]", "[[a]]", "[ \"\u00e9\" ]", "['']", "[1]"}) {
    EXPECT_TRUE(parse_toml("x = [\n[+1],\n  [{y = 1}]]\n" + std::string(header) + "\n")) << header;
  }
}

TEST(TomlText, BracketsThatCloseOthersAreRefusedWithTheirLine) {
  for (const char* text : {"x = 1\ny = [1,}\n", "x = 1\ny = {a = [1.5,}\n", "x = 1\n[y}\n",
                           "x = 1\ny = {a = 1]\n", "x = 1\ny = [{a = [1, '}', \"]\"}]}]\n"}) {
    const auto parsed = parse_toml(text);
    ASSERT_FALSE(parsed) << text;
    EXPECT_EQ(parsed.error().source().begin.line, 2u);
  }
}

TEST(TomlText, DatesAndTimesAreRefusedWithTheirLine) {
  for (const char* value :
       {"= 1979-05-27T.7:32:00Z", "= 07:32", ": 2", "= 1979-85-2x 7", "= [1979-05-27]"}) {
    const auto parsed = parse_toml("x = 1\ny " + std::string(value) + "\n");
    ASSERT_FALSE(parsed) << value;
    EXPECT_EQ(parsed.error().source().begin.line, 2u);
  }
  EXPECT_TRUE(parse_toml("x = 'a:b 1979-05-27'  # c:d\ny = -1979\nz = 1000e-3\nr-2000-b = 1\n"));
}

TEST(TomlText, QuotesWithinWordsAreRefusedWithTheirLine) {
  for (const char* value : {"1.d\"\"\"b\u044f9", "'a''b'", "\"a\"'b'", "\"\"\"a\"\"\"\"\"\"",
                            "a'b'", "0.'\u00c9437", "[1, x.'\u00c9']", "{a.'b' = c.'\u00c9'}"}) {
    const auto parsed = parse_toml("x = 1\ny = " + std::string(value) + "\n");
    ASSERT_FALSE(parsed) << value;
    EXPECT_EQ(parsed.error().source().begin.line, 2u);
  }
  EXPECT_TRUE(parse_toml("x = \"\"\"\"a\"\"\"\"\"\ny = ['''b'''',\"\",'']\nz.'a'.\"b\"='c'\n"));
  EXPECT_TRUE(parse_toml("x = {a.'\u00c9' = [{b.'\u00c9' = 1}]}\n[a.'\u00c9'.\"\u00c9\"]\n"));
}

TEST(TomlText, BackslashesBeforeOtherThanAsciiAreRefused) {
  for (const char* text : {"x = \"\\\u00e9\"\n", "x = \"\"\"a\\\n  \u00e9\"\"\"\n",
                           "x = \"\"\"a\\\\\\\ufef2\"\"\"\n"}) {
    EXPECT_FALSE(parse_toml(text)) << text;
  }
  EXPECT_TRUE(parse_toml("x = \"\\\\\u00e9\"\ny = '\\\u00e9'\nz = \"\"\"a\\\n  b\u00e9\"\"\"\n"));
}

TEST(TomlText, ControlCharactersAndWhatIsNoUtf8AreRefusedWithTheirLine) {
  for (const char* text :
       {"x = 1\n[\x06]\n", "x = 1\n# \x1b[31m\n", "x = 1\ny = '\x7f'\n", "x = 1\ny = '\xff'\n",
        "x = 1\n\xc0\xaf\n", "x = 1\n\u00cd = 1\n", "x = 1\ny = \u00cd\n"}) {
    const auto parsed = parse_toml(text);
    ASSERT_FALSE(parsed) << text;
    EXPECT_EQ(parsed.error().source().begin.line, 2u);
  }
  EXPECT_TRUE(parse_toml("# t\tab\r\nx = '\u00e9\u202e'\r\n"));
}

TEST(TomlText, ManyDotsElsewhereAreNoKeys) {
  const std::string dots(1000, '.');
  for (const std::string& text :
       {"# " + dots + "\nx = 1\n", "x = \"" + dots + "\"\n", "x = '" + dots + "'\n",
        "x = \"\"\"\n\\\"" + dots + "\n\"\"\"\n", "x = '''\n" + dots + "\n'''\n",
        "x = [" + repeated("1.5, ", 1000) + "2.5]\n", "x = \"a\\\\\"  # " + dots + "\n",
        "a" + repeated(".b", kMaxKeyDots) + " = 1\n"}) {
    EXPECT_TRUE(parse_toml(text)) << text.substr(0, 40);
  }
}

TEST(TomlText, DeepestFilesThatAreTakenComeApartAgain) {
  std::string text = "x = ";
  for (int i = 0; i < 250; ++i) text += "{a" + repeated(".a", kMaxKeyDots) + " = ";
  text += "1" + std::string(250, '}') + "\n";
  EXPECT_TRUE(parse_toml(text));
}

TEST(TomlText, OnlyFilesOfASizeForPeopleAreRead) {
  tools::TemporaryFolder folder;
  const auto path = folder.path() / "robot.toml";
  for (const Trap& trap : traps()) {
    SCOPED_TRACE(trap.kind);
    trap.lay(path);
    Problems problems(path);
    read_settings(path, {}, problems);
    ASSERT_TRUE(problems.any());
    EXPECT_THAT(problems.error().message, AllOf(HasSubstr(path.string()), HasSubstr(trap.told)));
    std::filesystem::remove(path);
  }
}

TEST(TomlText, ThousandsOfProblemsAreAHundredAndANumber) {
  double value = 0.0;
  const Settings settings = {{"camera.rate_hz", "1/s", 0, 100, "", &value}};
  std::string text = "[camera]\n";
  for (int i = 0; i < 20'000; ++i) text += "k" + std::to_string(i) + "=1\n";
  text += std::string(20'000, 'x') + " = 1\n";
  Problems problems("x.toml");
  parse_settings(text, settings, problems);
  const std::string message = problems.error().message;
  EXPECT_THAT(message, AllOf(HasSubstr("x.toml:2: unknown key camera.k0"),
                             HasSubstr("19901 more problems")));
  EXPECT_LT(message.size(), 20'000u);
}

}  // namespace
}  // namespace zenith
