// What a package installs around the programs: units that systemd accepts and calls well guarded,
// and manual page and completion that know all commands.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/figure.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

using testing::HasSubstr;
using tools::read_text;
using tools::write_text;

struct Said {
  int exit_code = -1;
  std::string text;
};

Said run(const std::string& command) {
  Said said;
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return said;
  char part[512];
  while (std::fgets(part, sizeof part, pipe) != nullptr) said.text += part;
  said.exit_code = WEXITSTATUS(::pclose(pipe));
  return said;
}

class UnitTest : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (run("systemd-analyze --version").exit_code != 0) {
      GTEST_SKIP() << "SKIPPED, the units were not checked: there is no systemd-analyze";
    }
    if (!std::filesystem::exists(std::string(ZENITH_UNITS) + "/" + GetParam())) {
      GTEST_SKIP() << "SKIPPED: the build has no Cyclone DDS";
    }
    // A program is where it was built.
    std::string text = read_text(std::string(ZENITH_UNITS) + "/" + GetParam());
    text = std::regex_replace(text, std::regex("ExecStart=/usr/bin/[^ ]*"),
                              std::string("ExecStart=") + ZENITHD);
    write_text(unit_, text);
  }
  tools::TemporaryFolder folder_;
  const std::string unit_ = (folder_.path() / GetParam()).string();
};

TEST_P(UnitTest, SystemdAcceptsIt) {
  const Said said = run("systemd-analyze verify --man=no " + unit_);
  EXPECT_EQ(said.exit_code, 0) << said.text;
  EXPECT_THAT(said.text, testing::Not(HasSubstr(GetParam()))) << "a warning";
}

TEST_P(UnitTest, IsGuardedAsFarAsTheDaemonsNeedsAllow) {
  const Said said = run("systemd-analyze security --offline=yes " + unit_);
  std::smatch found;
  ASSERT_TRUE(std::regex_search(said.text, found, std::regex("exposure level for .*: ([0-9.]+)")))
      << said.text;
  const double exposure = std::stod(found[1]);
  print_figure("exposure of %s: %.1f of 10", GetParam(), exposure);
  EXPECT_LE(exposure, 2.0) << said.text;
}

std::string short_name(const testing::TestParamInfo<const char*>& unit) {
  constexpr const char* kNames[] = {"Single", "Instance", "Ros2"};
  return kNames[unit.index];
}

INSTANTIATE_TEST_SUITE_P(Units, UnitTest,
                         testing::Values("zenithd.service", "zenithd@.service",
                                         "zenith-ros2.service"),
                         short_name);

// What the help of `command` lists.
std::vector<std::string> subcommands(const std::string& command) {
  const std::string help = run(std::string(ZENITH_TOOL) + command + " --help").text;
  const std::size_t begin = help.find("Subcommands:");
  if (begin == std::string::npos) return {};
  const std::string list = help.substr(begin, help.find("\n\n", begin) - begin);
  std::vector<std::string> names;
  const std::regex name("\n  ([a-z]+) ");
  for (std::sregex_iterator at(list.begin(), list.end(), name), end; at != end; ++at) {
    names.push_back(at->str(1));
  }
  return names;
}

TEST(Packaging, ManualPageAndHelpKnowTheSameCommands) {
  const std::string page = read_text(ZENITH_SOURCE_DIR "/docs/man/zenith.1");
  const auto names = subcommands("");
  EXPECT_GE(names.size(), 8u);
  for (const std::string& name : names) EXPECT_THAT(page, HasSubstr("\n.B " + name + "\n"));
}

TEST(Packaging, TheMapsManualPageAndHelpKnowTheSameSubcommands) {
  const std::string page = read_text(ZENITH_SOURCE_DIR "/docs/man/zenith-map.1");
  const auto names = subcommands(" map");
  EXPECT_EQ(names.size(), 5u);
  for (const std::string& name : names) {
    EXPECT_THAT(page, HasSubstr("\n.B zenith map " + name + "\n"));
    EXPECT_THAT(page, HasSubstr("\n.TP\n.B " + name + "\n"));
  }
}

// Two daemons on a board keep two maps, and a purge finds all of them.
TEST(Packaging, InstancesHaveStateFoldersOfTheirOwn) {
  const std::string units = ZENITH_UNITS;
  EXPECT_THAT(read_text(units + "/zenithd.service"), HasSubstr("\nStateDirectory=zenith\n"));
  EXPECT_THAT(read_text(units + "/zenithd@.service"), HasSubstr("\nStateDirectory=zenith-%i\n"));
  EXPECT_THAT(read_text(ZENITH_SOURCE_DIR "/systemd/package/postrm"),
              HasSubstr("rm -rf /var/lib/zenith /var/lib/zenith-*\n"));
}

// In a user namespace of its own it could not tell the user zenith from strangers.
TEST(Packaging, TheBridgeSeesWhoseSocketItReads) {
  EXPECT_THAT(read_text(ZENITH_SOURCE_DIR "/systemd/zenith-ros2.service"),
              testing::Not(HasSubstr("\nPrivateUsers=")));
}

TEST(Packaging, TheShellCompletesCommandsAndOptions) {
  const std::string complete =
      "bash -c 'source " ZENITH_SOURCE_DIR "/tools/completion/zenith; COMP_CWORD=$0; COMP_WORDS=(" +
      std::string(ZENITH_TOOL) + " \"$@\"); _zenith; echo \"${COMPREPLY[*]}\"' ";
  EXPECT_EQ(run(complete + "1 rep").text, "replay\n");
  EXPECT_THAT(run(complete + "2 replay --o").text, HasSubstr("--out"));
  EXPECT_EQ(run(complete + "2 calibrate le").text, "lens\n");
  EXPECT_THAT(run(complete + "3 calibrate lens --c").text, HasSubstr("--camera"));
}

#ifdef ZENITH_ROS2
TEST(Packaging, TheBridgesPageAndCompletionKnowTheOptionsOfItsHelp) {
  const std::string help = run(std::string(ZENITH_ROS2) + " --help").text;
  const std::string page = std::regex_replace(
      read_text(ZENITH_SOURCE_DIR "/docs/man/zenith-ros2.1"), std::regex("\\\\-"), "-");
  const std::string complete =
      "bash -c 'source " ZENITH_SOURCE_DIR
      "/tools/completion/zenith-ros2; COMP_CWORD=$0; COMP_WORDS=(" ZENITH_ROS2
      " \"$@\"); _zenith_ros2; echo \"${COMPREPLY[*]}\"' ";
  const std::string completed = run(complete + "1 --").text;
  int count = 0;
  const std::regex option("--[a-z][a-z-]*");
  const std::string options = help.substr(0, help.find("Examples:"));
  for (std::sregex_iterator at(options.begin(), options.end(), option), end; at != end; ++at) {
    EXPECT_THAT(page, HasSubstr(at->str()));
    EXPECT_THAT(completed, HasSubstr(at->str()));
    ++count;
  }
  EXPECT_GE(count, 9);
  EXPECT_EQ(run(complete + "2 --names al").text, "always\n");
}
#endif

}  // namespace
}  // namespace zenith
