// What `zenith view` listens to besides sockets of this computer: robots over ssh; and the demo's
// own page.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/patience.h"
#include "tests/system/page_client.h"
#include "tests/system/sim_daemon.h"
#include "tests/system/view_server.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

constexpr double kLimit_s = kPatience_s;
constexpr const char* kSsh = "/usr/bin/ssh";
constexpr const char* kSshd = "/usr/sbin/sshd";

bool shell(const std::string& command) {
  return std::system(("(" + command + ") >/dev/null 2>&1").c_str()) == 0;
}

// A page that has just been opened sees what `holds`, within the limit.
template <typename Holds>
bool page_sees(const ViewServer& view, const json& request, Holds holds) {
  return wait_until(kLimit_s, [&] {
    PageClient page(view.port(), view.token());
    if (page.upgrade("/live", "").find("101") == std::string::npos) return false;
    const json answer = page.ask(request);
    return answer.is_object() && holds(answer["robots"]);
  });
}

class ViewOverSsh : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(folder_.path() / "bin");
    fs::create_symlink(ZENITH_TOOL, folder_.path() / "bin" / "zenith");
  }
  std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  void write_ssh(const std::string& script) {
    tools::write_text(file("bin/ssh"), "#!/bin/bash\n" + script);
    fs::permissions(file("bin/ssh"), fs::perms::owner_all);
  }
  bool start_view() {
    return view_.start({"ssh:anna:" + file("r1.sock")}, kLimit_s,
                       {{"PATH", file("bin") + ":" + std::getenv("PATH")}});
  }
  // Lines come, pictures come when they are asked for, and a daemon that begins anew is found.
  void expect_robot() {
    ASSERT_TRUE(page_sees(view_, json::object(), [](const json& robots) {
      return robots[0]["name"] == "r1" && robots[0]["set"].contains("pose");
    })) << view_.log();
    EXPECT_TRUE(page_sees(view_, {{"picture", 0}},
                          [](const json& robots) { return robots[0].contains("picture"); }));
    r1_.kill();
    EXPECT_TRUE(page_sees(view_, json::object(), [](const json& robots) {
      return robots[0]["set"]["link"]["up"] == false;
    }));
    ASSERT_TRUE(r1_.start()) << r1_.log();
    EXPECT_TRUE(page_sees(view_, json::object(), [](const json& robots) {
      return robots[0]["set"]["link"]["up"] == true;
    }));
    EXPECT_EQ(view_.stop(), 0);
  }

  tools::TemporaryFolder folder_;
  SimDaemon r1_{folder_.path(), "r1", ""};
  ViewServer view_{folder_.path()};
};

// An ssh that stays here; whether its words are what the real one takes, that one says.
TEST_F(ViewOverSsh, SpeaksToSshAsItWants) {
  const std::string check = fs::exists(kSsh) ? std::string(kSsh) + " -G \"$@\" >/dev/null\n" : "";
  write_ssh("set -e\n" + check +
            "while [[ $1 != -- ]]; do shift; done\n[[ $2 == anna ]]\nshift 2\n" + "exec \"$@\"\n");
  ASSERT_TRUE(r1_.start()) << r1_.log();
  ASSERT_TRUE(start_view()) << view_.log();
  expect_robot();
}

TEST_F(ViewOverSsh, SaysWhenSshFails) {
  write_ssh("echo 'no route to anna' >&2\nexit 255\n");
  ASSERT_TRUE(start_view()) << view_.log();
  EXPECT_TRUE(page_sees(view_, json::object(), [](const json& robots) {
    const std::string why = robots[0]["set"]["link"].value("why", "");
    return why.find("ssh anna zenith telemetry: ended; try it in a shell") != std::string::npos;
  }));
  EXPECT_EQ(view_.stop(), 0);
  EXPECT_THAT(view_.log(), HasSubstr("no route to anna"));
}

// The real thing, over this computer's loopback network.
TEST_F(ViewOverSsh, WorksWithARealServer) {
  if (!fs::exists(kSshd) || !fs::exists(kSsh) || ::geteuid() != 0) {
    GTEST_SKIP() << "SKIPPED: a robot over a real ssh was not tested: there is no openssh-server, "
                    "or this is not root";
  }
  const std::string port = std::to_string(20000 + ::getpid() % 20000);
  tools::write_text(
      file("sshd_config"),
      "ListenAddress 127.0.0.1:" + port + "\nHostKey " + file("host") + "\nAuthorizedKeysFile " +
          file("user.pub") +
          "\nStrictModes no\nUsePAM no\nPermitRootLogin prohibit-password\nPidFile none\n" +
          "SetEnv PATH=" + file("bin") + ":/usr/bin:/bin\n");
  tools::write_text(file("ssh_config"),
                    "Host anna\nHostName 127.0.0.1\nPort " + port + "\nIdentityFile " +
                        file("user") +
                        "\nStrictHostKeyChecking no\nUserKnownHostsFile /dev/null\n");
  for (const char* key : {"host", "user"}) {
    ASSERT_TRUE(shell("ssh-keygen -q -t ed25519 -N '' -f " + file(key)));
  }
  ASSERT_TRUE(shell("mkdir -p /run/sshd"));
  const Process sshd({kSshd, "-D", "-e", "-f", file("sshd_config")}, file("sshd.out"),
                     file("sshd.log"));
  write_ssh("exec " + std::string(kSsh) + " -F " + file("ssh_config") + " \"$@\"\n");
  ASSERT_TRUE(r1_.start()) << r1_.log();
  ASSERT_TRUE(start_view()) << view_.log();
  expect_robot();
  if (HasFailure()) std::cout << tools::read_text(file("sshd.log")) << view_.log();
}

class DemoPage : public testing::Test {
 protected:
  // A desktop whose browser writes down what it is to open.
  DemoPage() {
    const fs::path opener = folder_.path() / "bin" / "xdg-open";
    fs::create_directory(opener.parent_path());
    tools::write_text(opener,
                      "#!/bin/bash\necho \"$@\" >" + (folder_.path() / "opened").string() + "\n");
    fs::permissions(opener, fs::perms::owner_all);
  }
  bool start() {
    return view_.run({"demo", "--view", "--port", "0", "--duration", "8", "--out",
                      (folder_.path() / "demo").string()},
                     kLimit_s,
                     {{"PATH", (folder_.path() / "bin").string() + ":" + std::getenv("PATH")},
                      {"DISPLAY", ":0"}});
  }
  bool shows_both() {
    return page_sees(view_, json::object(), [](const json& robots) {
      return robots.size() == 2 && robots[0]["set"].contains("pose") &&
             robots[1]["set"].contains("pose");
    });
  }
  tools::TemporaryFolder folder_;
  ViewServer view_{folder_.path()};
};

TEST_F(DemoPage, ShowsTheRobotsAndStaysUntilCtrlC) {
  ASSERT_TRUE(start()) << view_.log();
  EXPECT_TRUE(shows_both());
  ASSERT_TRUE(wait_until(kLimit_s, [&] {
    return view_.said().find("The robots have ended") != std::string::npos;
  })) << view_.said();
  EXPECT_TRUE(wait_until(kLimit_s, [&] {
    // A file that leads on: the token stands in no command line.
    std::string file = tools::read_text(folder_.path() / "opened");
    if (!file.empty() && file.back() == '\n') file.pop_back();
    return tools::read_text(file).find("url=" + view_.address() + "\"") != std::string::npos;
  })) << "the browser";
  EXPECT_TRUE(fs::exists(folder_.path() / "demo" / "map.png"));
  EXPECT_TRUE(shows_both()) << "as they were";
  EXPECT_TRUE(page_sees(view_, json::object(), [](const json& robots) {
    return robots[1]["set"]["link"]["why"] == "the demo has ended";
  }));
  EXPECT_EQ(view_.stop(), 0);
}

TEST_F(DemoPage, CtrlCEndsTheRobotsToo) {
  ASSERT_TRUE(start()) << view_.log();
  EXPECT_EQ(view_.stop(), 1);
  EXPECT_FALSE(fs::exists(folder_.path() / "demo")) << "the half of a demo";
  EXPECT_FALSE(shell("pgrep -f 'zenithd-si[m] .*" + folder_.path().string() + "'"))
      << "a robot goes on";
}

}  // namespace
}  // namespace zenith
