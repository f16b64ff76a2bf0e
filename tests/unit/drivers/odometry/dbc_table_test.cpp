// Generated DBC files against another reader: tests/support/dbc_table.mjs made dbc_table.txt.

#include "tests/unit/drivers/odometry/dbc_table.h"

#include <filesystem>
#include <fstream>

namespace zenith {
namespace {

TEST(DbcTable, AnotherReaderFindsTheSameSignalsAndValues) {
  std::ifstream in(std::filesystem::path(ZENITH_SOURCE_DIR) /
                   "tests/unit/drivers/odometry/dbc_table.txt");
  ASSERT_TRUE(in);
  DbcTable table;
  std::string line;
  int files = 0;
  while (in && !line.starts_with("file ")) std::getline(in, line);
  while (line.starts_with("file ")) {
    SCOPED_TRACE(line);
    const bool crlf = line.ends_with("crlf");
    std::string text;
    while (in.peek() == '|' && std::getline(in, line)) {
      text += line.substr(1) + (crlf ? "\r\n" : "\n");
    }
    const auto file = parse_dbc(text, "table.dbc");
    ASSERT_TRUE(file.ok()) << file.error().message;
    table.compare(in, *file, line);
    ++files;
  }
  EXPECT_EQ(files, 24);
  EXPECT_EQ(table.counts().signals, 24 * 17);
  EXPECT_GT(table.counts().values, 1000);
}

}  // namespace
}  // namespace zenith
