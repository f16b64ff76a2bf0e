// Real cars' DBC files and logs against another reader (tests/support/dbc_table.mjs, candied on
// node): the same signals, the same values. Without node or candied it says so and is skipped; the
// generated files of dbc_table_test.cpp need neither.
//
//   npm install --prefix ~/candied candied@2.2.0
//   NODE_PATH=~/candied/node_modules ./dev test ...

#include <cstdio>
#include <memory>
#include <sstream>

#include "tests/support/figure.h"
#include "tests/support/real_data.h"
#include "tests/unit/drivers/odometry/dbc_table.h"

namespace zenith {
namespace {

// What the command prints; empty when it fails.
std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), &::pclose);
  std::string text;
  char piece[4096];
  for (std::size_t size = 1; pipe && size > 0;) {
    size = std::fread(piece, 1, sizeof piece, pipe.get());
    text.append(piece, size);
  }
  return text;
}

void compare(const std::filesystem::path& dbc, const std::filesystem::path& log) {
  const std::string text = output_of("node '" ZENITH_SOURCE_DIR "/tests/support/dbc_table.mjs' '" +
                                     dbc.string() + "' '" + log.string() + "' 2>/dev/null");
  if (text.empty()) {
    GTEST_SKIP() << "node with the package candied is needed to compare " << dbc
                 << "; install it and set NODE_PATH";
  }
  const auto file = load_dbc(dbc.string());
  ASSERT_TRUE(file.ok()) << file.error().message;
  std::istringstream in(text);
  DbcTable table;
  std::string line;
  table.compare(in, *file, line);
  EXPECT_GT(table.counts().signals, 50);
  EXPECT_GT(table.counts().values, 1000);
  print_figure("%s: %d signals and %d values as another reader has them", dbc.c_str(),
               table.counts().signals, table.counts().values);
}

TEST(DbcReader, TheWheelsOfACar) {
  ZENITH_NEED_REAL_DATA("can_wheel_speeds");
  const auto folder = real_data_folder() / "can_wheel_speeds";
  compare(folder / "vehicle.dbc", folder / "candump.log");
}

TEST(DbcReader, TheBusOfTwoCars) {
  ZENITH_NEED_REAL_DATA("car_can_logs");
  for (const char* car : {"honda_civic8th", "subaru_vab"}) {
    const auto folder = real_data_folder() / "car_can_logs" / car;
    compare(folder / "car.dbc", folder / "can0.log");
  }
}

}  // namespace
}  // namespace zenith
