// The house keeps its own rules: see "Who may include whom" in the design, and
// tests/support/architecture_rules.h for how they are checked.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/architecture_rules.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> all_sources() {
  std::vector<fs::path> files;
  const fs::path root = ZENITH_SOURCE_DIR;
  for (const char* folder : {"platform", "slam", "drivers", "sim", "tools", "tests"}) {
    if (!fs::is_directory(root / folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string ending = entry.path().extension().string();
      if (entry.is_regular_file() && (ending == ".h" || ending == ".cpp" || ending == ".inc")) {
        files.push_back(fs::relative(entry.path(), root));
      }
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(Architecture, AllSourcesKeepTheRules) {
  const std::vector<fs::path> files = all_sources();
  ASSERT_GE(files.size(), 10u) << "sources were not found under " << ZENITH_SOURCE_DIR;
  for (const fs::path& file : files) {
    std::ifstream in(fs::path(ZENITH_SOURCE_DIR) / file);
    ASSERT_TRUE(in) << "cannot read " << file;
    std::ostringstream text;
    text << in.rdbuf();
    for (const Violation& violation : check_architecture(file.generic_string(), text.str())) {
      ADD_FAILURE() << violation.text();
    }
  }
}

// --- the check itself ---------------------------------------------------------------------------

struct Case {
  const char* file;
  const char* line;
  const char* rule;  // a part of the expected message, or nullptr when the line is allowed
};

void expect_rule(const Case& c) {
  SCOPED_TRACE(std::string(c.file) + ": " + c.line);
  const auto violations = check_architecture(c.file, std::string("\n") + c.line + "\n");
  if (c.rule == nullptr) {
    for (const Violation& violation : violations) ADD_FAILURE() << violation.text();
    return;
  }
  ASSERT_EQ(violations.size(), 1u);
  EXPECT_EQ(violations[0].file, c.file);
  EXPECT_EQ(violations[0].line, 2);
  EXPECT_NE(violations[0].rule.find(c.rule), std::string::npos) << violations[0].text();
}

constexpr Case kIncludes[] = {
    {"platform/base/a.h", "#include <cmath>", nullptr},
    {"platform/base/a.h", "#include <unistd.h>", "standard library alone"},
    {"platform/base/a.h", "#include \"slam/geometry.h\"", "standard library alone"},
    {"slam/image/a.h", "#include \"slam/geometry.h\"", nullptr},
    {"slam/image/a.h", "#include <immintrin.h>", nullptr},
    {"slam/image/a.h", "#include \"slam/filter/a.h\"", "no later one"},
    {"slam/image/a.h", "#include \"slam/slam.h\"", "called by the step"},
    {"slam/image/a.cpp", "#include \"slam/kernels/match/a.h\"", nullptr},
    {"slam/kernels/match/a.cpp", "#include \"slam/kernels/lanes.h\"", nullptr},
    {"slam/kernels/match/a.cpp", "#include \"slam/capacity.h\"", "slam/kernels includes"},
    {"slam/filter/a.h", "#include \"slam/map/a.h\"", nullptr},
    {"slam/filter/a.h", "#include \"slam/fleet/record.h\"", "do not include slam/fleet"},
    {"slam/map/a.h", "#include \"slam/fleet/record.h\"", "do not include slam/fleet"},
    {"slam/fleet/a.h", "#include \"slam/map/a.h\"", nullptr},
    {"slam/geometry.h", "#include \"slam/map/a.h\"", "no stage"},
    {"slam/slam.cpp", "#include \"slam/fleet/a.h\"", nullptr},
    {"slam/exchange/a.cpp", "#include \"slam/fleet/record.h\"", nullptr},
    {"slam/exchange/a.cpp", "#include \"slam/geometry.h\"", nullptr},
    {"slam/exchange/a.cpp", "#include \"slam/fleet/peer_map.h\"", "plain types of slam alone"},
    {"slam/exchange/a.cpp", "#include <vector>", "no heap"},
    {"slam/slam.cpp", "#include \"slam/exchange/a.h\"", "the core knows no network"},
    {"slam/step.h", "#include \"slam/map/a.h\"", nullptr},
    {"slam/map/a.h", "#include \"slam/step.h\"", "called by the step"},
    {"drivers/camera/a.h", "#include \"slam/slam.h\"", "plain types"},
    {"slam/slam.cpp", "#include \"drivers/radio/a.h\"", "Eigen and slam alone"},
    {"slam/map/a.cpp", "#include <opencv2/core.hpp>", "Eigen and the standard library alone"},
    {"slam/map/a.cpp", "#include <vector>", "no heap"},
    {"slam/map/a.cpp", "#include <Eigen/Core>", nullptr},
    {"drivers/camera/a.cpp", "#include \"drivers/leds/a.h\"", "each other's folders"},
    {"drivers/camera/a.cpp", "#include \"platform/linux/a.h\"", nullptr},
    {"drivers/camera/a.cpp", "#include \"slam/map/a.h\"", "plain types"},
    {"drivers/radio/a.cpp", "#include \"slam/fleet/record.h\"", nullptr},
    {"drivers/camera/a.cpp", "#include <linux/videodev2.h>", nullptr},
    {"drivers/camera/a.cpp", "#include <opencv2/core.hpp>", "OpenCV"},
    {"platform/linux/a.cpp", "#include \"drivers/camera/a.h\"", "platform/linux includes"},
    {"platform/daemon/a.cpp", "#include \"slam/slam.h\"", nullptr},
    {"platform/daemon/a.cpp", "#include \"sim/a.h\"", "include sim"},
    {"platform/daemon/a.cpp", "#include \"platform/daemon/simulated/a.h\"",
     "without the simulator"},
    {"platform/daemon/simulated/a.cpp", "#include \"sim/a.h\"", nullptr},
    {"platform/daemon/simulated/a.cpp", "#include \"platform/daemon/a.h\"", nullptr},
    {"tools/a.cpp", "#include \"platform/daemon/simulated/a.h\"", nullptr},
    {"sim/a.cpp", "#include \"platform/daemon/a.h\"", "includes platform/daemon"},
    {"platform/daemon/a.cpp", "#include \"platform/config/a.h\"", nullptr},
    {"tools/a.cpp", "#include \"platform/config/a.h\"", nullptr},
    {"platform/config/a.cpp", "#include \"slam/parameters.h\"", nullptr},
    {"platform/config/a.cpp", "#include \"slam/slam.h\"", "platform/config includes"},
    {"platform/config/a.cpp", "#include \"drivers/camera/camera.h\"", "platform/config includes"},
    {"platform/link/a.cpp", "#include \"slam/exchange/a.h\"", nullptr},
    {"platform/link/a.cpp", "#include \"slam/slam.h\"", "platform/link includes"},
    {"platform/link/a.cpp", "#include \"drivers/radio/a.h\"", "platform/link includes"},
    {"platform/link/a.cpp", "#include <sodium.h>", nullptr},
    {"platform/link/a.cpp", "#include <sys/socket.h>", "no socket"},
    {"platform/daemon/a.cpp", "#include \"platform/link/a.h\"", nullptr},
    {"platform/storage/a.cpp", "#include \"slam/exchange/a.h\"", nullptr},
    {"platform/storage/a.cpp", "#include \"slam/slam.h\"", "platform/storage includes"},
    {"platform/storage/a.cpp", "#include \"platform/link/a.h\"", "platform/storage includes"},
    {"platform/daemon/a.cpp", "#include <sodium.h>", "libsodium"},
    {"drivers/radio/a.cpp", "#include \"platform/link/a.h\"", "drivers include"},
    {"sim/a.cpp", "#include \"platform/link/a.h\"", nullptr},
    {"platform/daemon/a.cpp", "#include <opencv2/core.hpp>", "OpenCV"},
    {"sim/a.cpp", "#include \"tools/a.h\"", "include tools"},
    {"tools/a.cpp", "#include \"sim/a.h\"", nullptr},
    {"tools/a.cpp", "#include \"tests/support/seeds.h\"", "only tests"},
    {"tests/unit/a.cpp", "#include \"tools/a.h\"", nullptr},
    {"tests/unit/a.cpp", "#include \"a.h\"", "from the root"},
};

TEST(ArchitectureRules, TellGoodIncludesFromBad) {
  for (const Case& c : kIncludes) expect_rule(c);
}

constexpr Case kCalls[] = {
    {"slam/a.cpp", "p = malloc(3);", "allocates nothing"},
    {"slam/a.cpp", "auto* p = new State;", "placement new"},
    {"slam/a.cpp", "state_ = new (memory.data()) State();", nullptr},
    {"slam/a.cpp", "delete state_;", "frees nothing"},
    {"slam/a.cpp", "Slam(const Slam&) = delete;", nullptr},
    {"slam/a.cpp", "std::vector<int> v;", "fixed containers"},
    {"slam/a.cpp", "std::string s;", "fixed containers"},
    {"slam/a.cpp", "std::string_view s;", nullptr},
    {"slam/a.cpp", "Eigen::MatrixXd m;", "fixed size"},
    {"slam/a.cpp", "Eigen::Matrix3Xf m;", "fixed size"},
    {"slam/a.cpp", "Eigen::Matrix3d m;", nullptr},
    {"slam/a.cpp", "std::thread t(f);", "no thread"},
    {"slam/a.cpp", "auto t = std::chrono::steady_clock::now();", "no clock"},
    {"slam/a.cpp", "t = time(nullptr);", "no clock"},
    {"slam/a.cpp", "x = rand();", "randomness"},
    {"slam/a.cpp", "std::cout << 1;", "writes and reads nothing"},
    {"slam/a.cpp", "throw 1;", "no exceptions"},
    {"slam/a.cpp", "// a new std::vector in a comment", nullptr},
    {"slam/a.cpp", "/* malloc( */ int x = 1'000'000;", nullptr},
    {"slam/a.cpp", "const char* text = \"std::thread \\\" new X\";", nullptr},
    {"drivers/camera/a.cpp", "try { f(); }", "no exceptions"},
    {"tools/a.cpp", "std::ifstream in(path);", "files are read through"},
    {"tools/a.cpp", "std::ofstream out(path);", nullptr},
    {"sim/a.cpp", "auto t = toml::parse_file(path);", "files are read through"},
    {"platform/recording/a.cpp", "auto y = YAML::LoadFile(path);", "files are read through"},
    {"tools/a.cpp", "cv::Mat m = cv::imread(path);", "files are read through"},
    {"tests/a.cpp", "std::ifstream in(path);", nullptr},
    {"platform/config/a.cpp", "throw 1;", "no exceptions"},
    {"platform/linux/a.cpp", "dynamic_cast<A*>(b);", "no RTTI"},
    {"tools/a.cpp", "std::vector<int> v;", nullptr},
};

TEST(ArchitectureRules, TellGoodCallsFromBad) {
  for (const Case& c : kCalls) expect_rule(c);
}

TEST(StripSource, KeepsLineNumbersAndIncludePaths) {
  const std::string out = strip_comments_and_literals(
      "#include \"slam/slam.h\"  // why\n/* two\nlines */ int a = 'x';\nR\"(\n\")\" b;\n");
  EXPECT_EQ(out, "#include \"slam/slam.h\"   \n \n int a =  ;\n \n b;\n");
}

}  // namespace
}  // namespace zenith
