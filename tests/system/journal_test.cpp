// The daemon's log where it goes to journald: entries with fields, through the journal's socket.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "tests/support/journal_reader.h"
#include "tests/support/patience.h"
#include "tests/system/sim_daemon.h"

namespace zenith {
namespace {

// In a folder of mounts of its own, so that the journal of this computer is left alone.
constexpr const char* kWithJournal =
    "mount --make-rprivate / && mkdir -p /run/systemd && mount --bind \"$0\" /run/systemd && "
    "JOURNAL_STREAM=$(stat -Lc %d:%i /proc/self/fd/2) exec \"$@\"";

TEST(Journal, GetsEventsWithTheirFields) {
  if (::geteuid() != 0) {
    GTEST_SKIP() << "SKIPPED, the way to journald was not tested: only root may mount";
  }
  const tools::TemporaryFolder folder;
  const std::string run = (folder.path() / "run").string();
  std::filesystem::create_directories(run + "/journal");
  const JournalReader journal(run + "/journal/socket");
  const SimDaemon configured(folder.path(), "r1", "enabled = false\n");
  Process daemon({"/usr/bin/unshare", "--mount", "/bin/sh", "-c", kWithJournal, run, ZENITHD_SIM,
                  "--config", (folder.path() / "r1.toml").string()},
                 (folder.path() / "out").string(), (folder.path() / "log").string());
  std::map<std::string, JournalFields> events;
  const auto hear = [&](const std::string& event) {
    while (events.count(event) == 0) {
      const JournalFields fields = journal.next();
      if (fields.empty()) return false;
      EXPECT_EQ(fields.at("SYSLOG_IDENTIFIER"), "zenithd-sim");
      if (fields.count("ZENITH_EVENT") != 0) events[fields.at("ZENITH_EVENT")] = fields;
    }
    return true;
  };
  ASSERT_TRUE(hear("first-pose")) << tools::read_text(folder.path() / "log");
  daemon.send(SIGTERM);
  ASSERT_TRUE(hear("frames-counted"));
  EXPECT_EQ(daemon.wait(kPatience_s), 0);
  EXPECT_EQ(events["started"]["ZENITH_ROBOT"], "r1");
  EXPECT_EQ(events["started"]["PRIORITY"], "5");
  EXPECT_EQ(events["ready"]["MESSAGE"], "ready");
  EXPECT_EQ(events.count("camera-opened"), 1u);
  EXPECT_EQ(events.count("can-opened"), 1u);
  EXPECT_EQ(events.count("stopping"), 1u);
  EXPECT_GT(std::stod(events["frames-counted"]["ZENITH_IN_TIME"]) +
                std::stod(events["frames-counted"]["ZENITH_LATE"]),
            0.0);
  EXPECT_EQ(tools::read_text(folder.path() / "log"), "") << "each line once";
}

}  // namespace
}  // namespace zenith
