// The commands of README.md and docs/ do what the pages say: every ```sh block is run, page by
// page, with the programs of this build, in a folder that looks like a clone of the project. What a
// note above a block means stands in tests/README.md.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/file.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <memory>
#include <regex>

#include "platform/link/fleet_key.h"
#include "tests/support/markdown.h"
#include "tests/support/patience.h"
#include "tests/system/net_world.h"
#include "tests/system/process.h"
#include "tests/system/shell_block.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;

constexpr double kBlock_s = kPatience_s;
constexpr double kMoment_s = 1.5;  // before Ctrl-C, counted from the first word that is said
constexpr double kFirstWord_s = kPatience_s;

std::string page_name(const fs::path& page) {
  std::string name = page.lexically_relative(ZENITH_SOURCE_DIR).replace_extension().string();
  std::replace_if(
      name.begin(), name.end(), [](char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

// A clone in which everything is built. `./dev` is not the real one, which would build it all
// again: it says whether the real one knows the command, and leaves behind what `./dev demo` does.
void make_clone(const fs::path& folder) {
  const std::map<std::string, const char*> programs = {
#ifdef ZENITH_ROS2
      {"tools/ros2/zenith-ros2", ZENITH_ROS2},
#endif
      {"tools/zenith", ZENITH_TOOL},
      {"platform/daemon/zenithd", ZENITHD},
      {"platform/daemon/zenithd-sim", ZENITHD_SIM}};
  fs::create_directories(folder / "bin");
  fs::create_directories(folder / "run");
  fs::create_directories(folder / "etc");
  for (const auto& [place, program] : programs) {
    fs::create_symlink(program, folder / "bin" / fs::path(place).filename());
    for (const char* preset : {"dev", "release"}) {
      fs::create_directories((folder / "build" / preset / place).parent_path());
      fs::create_symlink(program, folder / "build" / preset / place);
    }
  }
  fs::copy(fs::path(ZENITH_SOURCE_DIR) / "config", folder / "config");
  std::ofstream(folder / "dev") << "#!/bin/bash\nset -euo pipefail\ndev=" ZENITH_SOURCE_DIR "/dev\n"
                                << R"BASH(
look=0
if [[ $1 == --only-look ]]; then look=1; shift; fi
help=$("$dev" help)
has() { grep -q "$@" <<<"$help" || { echo "./dev help has no ${*: -1}" >&2; exit 1; }; }
has -E "^  $1( |\$)"
for word in "${@:2}"; do
  if [[ $word == --* ]]; then has -F -e "$word"; fi
done
if [[ $look == 0 && $1 == demo ]]; then zenith demo --offline --duration 3 --out out/demo; fi
)BASH";
  fs::permissions(folder / "dev", fs::perms::owner_all);
}

class DocumentedCommands : public testing::TestWithParam<fs::path> {
 protected:
  void SetUp() override {
    make_clone(folder_.path());
    ASSERT_TRUE(create_fleet_key(folder_.path() / "etc" / "fleet.key").ok());
    if (network_.good()) return;
    // Two pages at a time would want the same ports.
    const fs::path lock = fs::temp_directory_path() / "zenith-documentation.lock";
    alone_ = UniqueFd(::open(lock.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0644));
    ASSERT_EQ(::flock(alone_.get(), LOCK_EX), 0);
  }

  std::string file(const std::string& name) const { return (folder_.path() / name).string(); }

  // Starts a block; with a network of its own where that is permitted.
  std::unique_ptr<Process> start(const CodeBlock& block, const std::string& log) {
    std::ofstream(file(log + ".sh")) << "set -euo pipefail\ncd " << folder_.path() << "\n"
                                     << block.text;
    std::unique_ptr<Process> process;
    const auto run = [&] {
      process = std::make_unique<Process>(
          std::vector<std::string>{"/bin/bash", file(log + ".sh")}, file(log + ".log"),
          file(log + ".err"),
          std::vector<Environment>{{"PATH", file("bin") + ":" + std::getenv("PATH")},
                                   {"HOME", folder_.path().string()},
                                   {"XDG_RUNTIME_DIR", file("run")}});
    };
    if (!network_.good() || !network_.on(1, run)) run();
    return process;
  }
  std::string said(const std::string& log) const {
    return tools::read_text(file(log + ".log")) + tools::read_text(file(log + ".err"));
  }
  bool speaks(const std::string& log) const {
    return wait_until(kFirstWord_s, [&] { return !said(log).empty(); });
  }
  static void a_moment() { sleep_until(monotonic_now() + Duration::from_seconds(kMoment_s)); }

  tools::TemporaryFolder folder_;
  NetWorld network_{1};
  UniqueFd alone_;
};

// Ctrl-C reaches the shell's child, too: both are of one process group.
void interrupt(Process& process) {
  process.send_group(SIGINT);
}

TEST_P(DocumentedCommands, Work) {
#ifndef ZENITH_ROS2
  if (GetParam().filename() == "ros2.md") GTEST_SKIP() << "SKIPPED: there is no Cyclone DDS";
#endif
  const Page page = read_page(GetParam());
  std::vector<std::pair<std::string, std::unique_ptr<Process>>> meanwhile;
  int number = 0;
  for (const CodeBlock& block : page.blocks) {
    if (block.language != "sh" || block.note.compare(0, 6, "needs:") == 0) continue;
    const std::string log = "block" + std::to_string(++number);
    const std::string where = GetParam().string() + ":" + std::to_string(block.line) + "\n";
    auto process = start(block, log);
    if (!block.note.empty()) {
      ASSERT_TRUE(speaks(log)) << where << block.text << "says nothing";
      a_moment();
    }
    if (block.note == "meanwhile") {
      meanwhile.emplace_back(log, std::move(process));
      continue;
    }
    const bool until = block.note == "until Ctrl-C";
    if (until) interrupt(*process);
    const int code = process->wait(kBlock_s);
    const bool good = code == 0 || (until && code == 128 + SIGINT);
    ASSERT_TRUE(good) << where << block.text << "exit code " << code << "\n" << said(log);
  }
  for (auto& [log, process] : meanwhile) {
    interrupt(*process);
    EXPECT_EQ(process->wait(kBlock_s), 0) << said(log);
  }
}

// What is not run here is at least spelled as the programs want it.
TEST_P(DocumentedCommands, AreKnownToThePrograms) {
  std::vector<std::string> wrong;
  for (const CodeBlock& block : read_page(GetParam()).blocks) {
    if (block.language != "sh") continue;
    for (const ShellCommand& command : shell_commands(block.text)) {
      const std::string what = what_is_unknown(command, file("dev"));
      if (what.empty()) continue;
      wrong.push_back(GetParam().filename().string() + ":" +
                      std::to_string(block.line + command.line) + ": " + what);
    }
  }
  EXPECT_THAT(wrong, IsEmpty());
}

// Configurations on the pages are good ones.
TEST_P(DocumentedCommands, ConfigurationsAreGood) {
  for (const CodeBlock& block : read_page(GetParam()).blocks) {
    if (block.language != "toml" || block.note.compare(0, 6, "needs:") == 0) continue;
    const std::string text_here =
        std::regex_replace(block.text, std::regex("/etc/zenith"), file("etc"));
    std::ofstream(file("page.toml")) << text_here;
    // The one has real devices alone, the other simulated ones, too.
    std::string text;
    const auto check = [&](const char* program) {
      Process process({program, "--config", file("page.toml"), "--check"}, file("check.log"),
                      file("check.err"));
      const int code = process.wait(kBlock_s);
      text += said("check");
      return code == 0;
    };
    EXPECT_TRUE(check(ZENITHD) || check(ZENITHD_SIM))
        << GetParam().string() << ":" << block.line << "\n"
        << text;
  }
}

std::vector<fs::path> pages_with_commands() {
  std::vector<fs::path> pages = documentation_pages();
  pages.erase(std::remove_if(pages.begin(), pages.end(),
                             [](const fs::path& path) { return read_page(path).blocks.empty(); }),
              pages.end());
  return pages;
}

INSTANTIATE_TEST_SUITE_P(Page, DocumentedCommands, testing::ValuesIn(pages_with_commands()),
                         [](const auto& page) { return page_name(page.param); });

}  // namespace
}  // namespace zenith
