// Whole programs on files, folders and arguments of somebody who means harm: they end with a
// message, in time, and nothing of what they print steers a terminal.

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/base/printable.h"
#include "tests/support/hostile_files.h"
#include "tests/support/stored_maps.h"
#include "tests/system/process.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using tools::write_text;

// Sets a terminal's title, as a file's name may (no slash) and as text.
const std::string kEscape = "\x1b]0;owned\x07\u009b31m\u202e";
const std::string kShown = "\\x1b]0;owned\\x07\\u009b31m\\u202e";

class HostileFiles : public testing::Test {
 protected:
  struct Outcome {
    int code = 0;
    std::string text;  // of both streams
  };

  Outcome run(const std::vector<std::string>& words) const {
    const std::string output = (folder_.path() / "stdout").string();
    const std::string errors = (folder_.path() / "stderr").string();
    Process process(words, output, errors);
    Outcome outcome;
    outcome.code = process.wait(60.0);
    outcome.text = tools::read_text(output) + tools::read_text(errors);
    return outcome;
  }
  Outcome zenith(std::vector<std::string> words) const {
    words.insert(words.begin(), ZENITH_TOOL);
    return run(words);
  }

  // What every answer must be, also when the command succeeds.
  static void expect_harmless(const Outcome& outcome) {
    EXPECT_GE(outcome.code, 0) << "did not end";
    EXPECT_LT(outcome.code, 128) << "was killed by a signal";
    std::string text = outcome.text;
    std::replace(text.begin(), text.end(), '\n', ' ');
    std::replace(text.begin(), text.end(), '\t', ' ');
    EXPECT_TRUE(is_printable(text)) << printable(text);
    EXPECT_FALSE(text.empty());
  }
  // A refusal that shows the escape codes as text.
  void expect_told(const Outcome& outcome) const {
    expect_harmless(outcome);
    EXPECT_GT(outcome.code, 0);
    EXPECT_THAT(outcome.text, HasSubstr(kShown));
  }

  fs::path file(const std::string& name) const { return folder_.path() / name; }

  tools::TemporaryFolder folder_;
};

TEST_F(HostileFiles, NamesOfFilesDoNotSteerTheTerminal) {
  write_text(file(kEscape + ".zenmap"), "no map");
  write_text(file(kEscape + ".yaml"), "no: lens");
  write_text(file(kEscape + ".toml"), "no = 1");
  fs::create_directory(file(kEscape));
  const std::string out = file("out").string();
  expect_told(zenith({"map", "check", file(kEscape + ".zenmap")}));
  expect_told(zenith({"map", "show", file(kEscape)}));
  expect_told(zenith({"map", "export", file(kEscape), file("a.ply")}));
  expect_told(zenith({"replay", file(kEscape), "--out", out}));
  expect_told(zenith({"calibrate", "import", file(kEscape + ".yaml")}));
  expect_told(zenith({"calibrate", "drive", file(kEscape), "--out", out}));
  expect_told(zenith({"sim", file(kEscape + ".toml"), "--out", out}));
  expect_told(run({ZENITHD, "--check", "--config", file(kEscape + ".toml")}));
  const Outcome list = zenith({"map", "list", folder_.path()});
  expect_harmless(list);
  EXPECT_THAT(list.text, HasSubstr(kShown));
}

TEST_F(HostileFiles, ArgumentsDoNotSteerTheTerminal) {
  expect_told(zenith({kEscape}));
  expect_told(zenith({"eval", kEscape}));
  expect_told(zenith({"demo", "--set", kEscape}));
  expect_told(run({ZENITHD, kEscape}));
}

TEST_F(HostileFiles, WhatFilesSayDoesNotSteerTheTerminal) {
  // TOML and YAML write control characters as escapes of their own.
  const std::string quoted = "\"\\u001b]0;owned\\u0007\\u009b31m\\u202e\"";
  write_text(file("key.toml"), quoted + " = 1\n");
  write_text(file("word.toml"), "[odometry]\ncodec = " + quoted + "\n");
  write_text(file("name.toml"), "[robot]\nname = " + quoted + "\n");
  for (const char* name : {"key.toml", "word.toml", "name.toml"}) {
    expect_told(run({ZENITHD, "--check", "--config", file(name)}));
  }
  write_text(file("world.toml"), quoted + " = 1\n");
  expect_told(zenith({"sim", file("world.toml"), "--out", file("out").string()}));
  write_text(file("lens.yaml"),
             "camera_model: " + quoted +
                 "\nintrinsics: [1, 1, 1, 1]\nresolution: [640, 480]\ndistortion_model: none\n");
  expect_told(zenith({"calibrate", "import", file("lens.yaml")}));
}

TEST_F(HostileFiles, AStoredMapOfAnUnspeakableRobotIsRefused) {
  Random random(1, 1);
  storage::StoredMap map = storage::random_map(70, random);
  map.head.robot.assign("\x1b]0;owned\x07");
  const auto bytes = storage::encode_map(map);
  fs::create_directory(file("state"));
  write_text(file("state/map-0.zenmap"), {bytes.begin(), bytes.end()});
  const std::string evil = file("state/map-0.zenmap");
  for (const Outcome& outcome : {zenith({"map", "check", evil}), zenith({"map", "show", evil}),
                                 zenith({"map", "export", evil, file("a.ply")}),
                                 zenith({"map", "import", evil, file("b")})}) {
    expect_harmless(outcome);
    EXPECT_EQ(outcome.code, 1);
  }
  EXPECT_FALSE(fs::exists(file("a.ply")));
  const Outcome list = zenith({"map", "list", file("state")});
  expect_harmless(list);
  EXPECT_THAT(list.text, HasSubstr("name"));
}

TEST_F(HostileFiles, PipesDevicesAndEndlessFilesEndInAMessage) {
  const std::string out = file("out").string();
  for (const Trap& trap : traps()) {
    SCOPED_TRACE(trap.kind);
    for (const char* name : {"trap.zenmap", "trap.toml", "trap.yaml", "trap.png"}) {
      trap.lay(file(name));
    }
    const std::vector<Outcome> outcomes = {
        zenith({"map", "check", file("trap.zenmap")}),
        zenith({"map", "list", folder_.path()}),
        zenith({"sim", file("trap.toml"), "--out", out}),
        zenith({"calibrate", "import", file("trap.yaml")}),
        zenith({"calibrate", "lens", file("trap.png"), "--out", out}),
        zenith({"calibrate", "lens", folder_.path(), "--out", out}),
        run({ZENITHD, "--check", "--config", file("trap.toml")}),
    };
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      SCOPED_TRACE(i);
      expect_harmless(outcomes[i]);
      EXPECT_TRUE(outcomes[i].code > 0 || i == 1);
    }
    for (const char* name : {"trap.zenmap", "trap.toml", "trap.yaml", "trap.png"}) {
      fs::remove(file(name));
    }
  }
}

TEST_F(HostileFiles, ARobotsNameIsNoWayOutOfTheFolder) {
  const std::string world =
      tools::read_text(fs::path(ZENITH_SOURCE_DIR) / "tests/system/worlds/one-room.toml");
  const std::size_t name = world.find("name", world.find("[[robot]]"));
  ASSERT_NE(name, std::string::npos);
  std::string evil = world;
  evil.replace(name, world.find('\n', name) - name, "name = \"../elsewhere\"");
  write_text(file("world.toml"), evil);
  const Outcome outcome = zenith({"sim", file("world.toml"), "--out", file("in/out").string()});
  expect_harmless(outcome);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.text, HasSubstr("can name a folder"));
  EXPECT_FALSE(fs::exists(file("in/elsewhere")));
}

}  // namespace
}  // namespace zenith
