// zenithd as a whole, as the service manager starts it, with a simulated robot.

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/stat.h>

#include <array>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "platform/link/fleet_key.h"
#include "platform/storage/folder_lock.h"
#include "tests/support/figure.h"
#include "tests/support/line_reader.h"
#include "tests/support/patience.h"
#include "tests/system/process.h"
#include "tests/unit/tools/small_recording.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;
using namespace std::string_literals;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using tools::read_text;
using tools::write_text;

constexpr double kLimit_s = kPatience_s;  // what is waited for is a state

class DaemonTest : public testing::Test {
 protected:
  void configure(const std::string& more) {
    write_text(file_,
               "[robot]\nname = \"ada\"\n[camera]\ndriver = \"simulated\"\n[odometry]\n"
               "driver = \"simulated\"\n[telemetry]\nsocket = \"" +
                   socket_ + "\"\n" + more);
  }

  // The next line of this type; null when there is none.
  static nlohmann::json next(LineReader& reader, const std::string& type) {
    for (int i = 0; i < 500; ++i) {
      const std::string line = reader.next();
      if (line.empty()) break;
      EXPECT_EQ(line.back(), '\n');
      nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
      EXPECT_TRUE(json.is_object()) << line;
      if (json.value("type", "") == type) return json;
    }
    ADD_FAILURE() << "no line of type " << type;
    return {};
  }

  bool logged(const std::string& text) const {
    return wait_until(kLimit_s, [&] { return read_text(errors_).find(text) != std::string::npos; });
  }

  // Runs to the end; output and errors as one text.
  int run(std::vector<std::string> words, std::string& said) {
    Process process(words, output_, errors_);
    const int code = process.wait(kLimit_s);
    said = read_text(output_) + read_text(errors_);
    return code;
  }

  tools::TemporaryFolder folder_;
  const std::string file_ = (folder_.path() / "zenith.toml").string();
  const std::string socket_ = (folder_.path() / "telemetry.sock").string();
  const std::string notify_ = (folder_.path() / "notify.sock").string();
  const std::string output_ = (folder_.path() / "output.txt").string();
  const std::string errors_ = (folder_.path() / "errors.txt").string();
};

// Four frames a second, and all corners: what a slow computer can do, too.
constexpr const char* kEasy = "[simulation]\nframe_rate_hz = 4\n[load]\ncorners_min = ";

TEST_F(DaemonTest, RunsReloadsAndStops) {
  configure(std::string(kEasy) + "128\n");
  NotifySocket manager(notify_);
  ASSERT_TRUE(manager.bound());
  const Time started = monotonic_now();
  Process daemon({ZENITHD_SIM, "--config", file_}, output_, errors_,
                 {{"NOTIFY_SOCKET", notify_}, {"WATCHDOG_USEC", "4000000"}});
  ASSERT_TRUE(manager.heard("READY=1", kLimit_s)) << read_text(errors_);

  LineReader reader(socket_);
  ASSERT_TRUE(reader.connected());
  EXPECT_EQ(next(reader, "hello")["robot"], "ada");
  const auto first = next(reader, "pose");
  print_figure("daemon, simulated: first pose %.2f s after its start",
               (monotonic_now() - started).seconds());
  EXPECT_EQ(first["pose"].size(), 3u);
  EXPECT_EQ(first["covariance"].size(), 6u);
  EXPECT_TRUE(manager.heard("STATUS=mapping", kLimit_s));
  EXPECT_TRUE(manager.heard("WATCHDOG=1", kLimit_s));

  // A wrong file: told, and nothing changes.
  configure("[slam]\ncorners_max = 1000\nparticels = 3\n" + (kEasy + "128\n"s));
  daemon.send(SIGHUP);
  ASSERT_TRUE(manager.heard("RELOADING=1", kLimit_s));
  ASSERT_TRUE(manager.heard("READY=1", kLimit_s));
  EXPECT_TRUE(logged("the configuration stays as it was"));
  EXPECT_TRUE(logged(":10: slam.corners_max is 1000"));
  EXPECT_TRUE(logged(":11: unknown key slam.particels; did you mean slam.particles?"));
  EXPECT_EQ(next(reader, "health")["load"]["corners_max"], 128);

  // More mistakes than one site of the log may have lines: all are told.
  std::string mistakes = "[map]\n";
  for (int i = 101; i <= 125; ++i) mistakes += "no_such_key_" + std::to_string(i) + " = 1\n";
  configure(mistakes);
  daemon.send(SIGHUP);
  ASSERT_TRUE(manager.heard("READY=1", kLimit_s));
  for (int i = 101; i <= 125; ++i) {
    EXPECT_TRUE(logged("unknown key map.no_such_key_" + std::to_string(i))) << i;
  }

  // A right one: what may change does, the rest waits. The lamp is not there; it was looked for.
  configure(
      "rate_hz = 1\n[slam]\ncorners_max = 60\nparticles = 100\n[map]\ninterval_s = 9\n[leds]\n"
      "status = \"led:no-such-lamp\"\n[log]\nlevel = \"debug\"\n" +
      (kEasy + "20\n"s));
  daemon.send(SIGHUP);
  ASSERT_TRUE(manager.heard("READY=1", kLimit_s));
  EXPECT_TRUE(
      logged("configuration read again: load.corners_min, telemetry.rate_hz, leds.status, "
             "log.level, slam.corners_max"));
  EXPECT_TRUE(logged("needs a restart: map.interval_s, slam.particles"));
  EXPECT_TRUE(logged("no-such-lamp"));
  std::int64_t gap_ns = 0;  // lines that wait to be read are older
  for (int i = 0; i < 50 && gap_ns < 900'000'000; ++i) {
    const auto one = next(reader, "pose")["stamp_ns"].get<std::int64_t>();
    gap_ns = next(reader, "pose")["stamp_ns"].get<std::int64_t>() - one;
  }
  EXPECT_GE(gap_ns, 900'000'000) << "a pose a second";
  configure("[slam]\ncorners_max = 60\nparticles = 100\n" + (kEasy + "20\n"s));
  daemon.send(SIGHUP);
  ASSERT_TRUE(manager.heard("READY=1", kLimit_s));
  bool fewer = false;
  for (int i = 0; i < 20 && !fewer; ++i) {
    fewer = next(reader, "health")["load"]["corners_max"].get<int>() <= 60;
  }
  EXPECT_TRUE(fewer);

  // Held up for a while, it goes on.
  const auto before = next(reader, "pose")["stamp_ns"].get<std::int64_t>();
  daemon.send(SIGSTOP);
  sleep_until(monotonic_now() + Duration{500'000'000});
  daemon.send(SIGCONT);
  std::int64_t stamp = before;
  for (int i = 0; i < 100 && stamp < before + 1'500'000'000; ++i) {
    stamp = next(reader, "pose")["stamp_ns"].get<std::int64_t>();
  }
  EXPECT_GE(stamp, before + 1'500'000'000);

  auto health = next(reader, "health");
  for (int i = 0; i < 100 && health["map"]["created"] <= 50; ++i) health = next(reader, "health");
  EXPECT_GT(health["map"]["created"], 50);
  EXPECT_EQ(health["camera"]["opened"], 1);
  auto deadlines = next(reader, "deadlines");
  for (int i = 0; i < 100 && deadlines["step"]["count"] <= 10; ++i) {
    deadlines = next(reader, "deadlines");
  }
  EXPECT_GT(deadlines["wake_up"]["count"], 100);
  EXPECT_GT(deadlines["step"]["count"], 10);
  print_figure("daemon, simulated: page faults %s, wake-up %s, step %s",
               health["page_faults"].dump().c_str(), deadlines["wake_up"].dump().c_str(),
               deadlines["step"].dump().c_str());

  const Time asked = monotonic_now();
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(kLimit_s), 0) << read_text(errors_);
  print_figure("daemon, simulated: ended %.3f s after SIGTERM",
               (monotonic_now() - asked).seconds());
  EXPECT_TRUE(manager.heard("STOPPING=1", kLimit_s));
  EXPECT_FALSE(fs::exists(socket_));
}

// A recording of a second, of which one frame is gone: at its end the robot stands, and all goes
// on.
TEST_F(DaemonTest, PlaysARecordingAndStandsAtItsEnd) {
  const fs::path recording = folder_.path() / "rec";
  tools::write_small_recording(recording);
  fs::remove(recording / "mav0/cam0/data" / (std::to_string(tools::small_stamp(4).ns) + ".png"));
  write_text(file_,
             "[camera]\ndriver = \"replay\"\n[odometry]\ndriver = \"replay\"\n[replay]\n"
             "folder = \"rec\"\n[telemetry]\nsocket = \"" +
                 socket_ + "\"\n");
  std::string said;
  EXPECT_EQ(run({ZENITHD_SIM, "--config", file_, "--check"}, said), 0);
  EXPECT_THAT(said, AllOf(HasSubstr("replay of "), HasSubstr("32 x 24, 10 a second"),
                          ContainsRegex("own map: looks +[0-9.]+ MiB\n"),
                          ContainsRegex("total +[0-9.]+ MiB\n")));
  EXPECT_EQ(run({ZENITHD, "--config", file_, "--check"}, said), 2);
  EXPECT_THAT(said, AllOf(HasSubstr("camera.driver = \"replay\""), HasSubstr("zenithd-sim")));

  Process daemon({ZENITHD_SIM, "--config", file_}, output_, errors_);
  EXPECT_TRUE(logged("passed over"));
  EXPECT_TRUE(
      logged("the end of the recording rec: 10 frames, of which 1 were missing or damaged"));
  LineReader reader(socket_);
  ASSERT_TRUE(reader.connected());
  nlohmann::json health = next(reader, "health");
  const auto at_end = health["camera"]["frames"].get<int>();
  for (int i = 0; i < 50 && health["camera"]["frames"].get<int>() < at_end + 5; ++i) {
    health = next(reader, "health");
  }
  EXPECT_GE(health["camera"]["frames"].get<int>(), at_end + 5) << "it stands, and still sees";
  EXPECT_EQ(health["camera"]["damaged"], 1);
  EXPECT_EQ(health["camera"]["lost"], 0);
  EXPECT_EQ(health["can"]["up"], true);
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(kLimit_s), 0) << read_text(errors_);
}

TEST_F(DaemonTest, EndsOnInterruptAlsoRightAfterItsStart) {
  configure("");
  NotifySocket manager(notify_);
  Process daemon({ZENITHD_SIM, "--config", file_}, output_, errors_, {{"NOTIFY_SOCKET", notify_}});
  ASSERT_TRUE(manager.heard("READY=1", kLimit_s));
  daemon.send(SIGINT);
  EXPECT_EQ(daemon.wait(kLimit_s), 0) << read_text(errors_);
}

// Nobody reads what it prints, so that it has begun and not ended.
TEST_F(DaemonTest, AHangUpInItsFirstMomentsDoesNotEndIt) {
  const std::string pipe = (folder_.path() / "pipe").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const UniqueFd reader(::open(pipe.c_str(), O_RDONLY | O_NONBLOCK));
  const UniqueFd writer(::open(pipe.c_str(), O_WRONLY | O_NONBLOCK));
  ASSERT_GT(::fcntl(writer.get(), F_SETPIPE_SZ, 4096), 0);
  Process daemon({ZENITHD_SIM, "--print-reference"}, pipe, errors_);
  int filled = 0;
  ASSERT_TRUE(wait_until(
      kLimit_s, [&] { return ::ioctl(reader.get(), FIONREAD, &filled) == 0 && filled > 2048; }));
  for (const int signal : {SIGHUP, SIGUSR1, SIGALRM}) daemon.send(signal);
  int code = -1;
  std::array<char, 4096> text;
  EXPECT_TRUE(wait_until(kLimit_s, [&] {
    while (::read(reader.get(), text.data(), text.size()) > 0) {
    }
    code = daemon.wait(0.0);
    return code >= 0;
  }));
  EXPECT_EQ(code, 0);
}

// Started with some of standard input, output and error closed: no socket and no file gets their
// numbers, and with them what is printed.
TEST_F(DaemonTest, ClosedStandardFilesAreNotTakenForOthers) {
  configure("[record]\nenabled = false\n");
  write_text(folder_.path() / "start", "exec \"$@\" <&- >&- 2>&-\n");
  Process daemon({"/bin/sh", (folder_.path() / "start").string(), ZENITHD_SIM, "--config", file_},
                 output_, errors_);
  std::unique_ptr<LineReader> reader;
  ASSERT_TRUE(wait_until(kLimit_s, [&] {
    reader = std::make_unique<LineReader>(socket_);
    return reader->connected();
  }));
  for (const char* fd : {"0", "1", "2"}) {
    const std::string link = "/proc/" + std::to_string(daemon.pid()) + "/fd/" + fd;
    EXPECT_EQ(fs::read_symlink(link), "/") << fd;
  }
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(kLimit_s), 0);
}

// No camera, no CAN bus: READY all the same, and what is missing is told again and again.
TEST_F(DaemonTest, RealDevicesMayBeMissing) {
  write_text(file_,
             "[camera]\ndevice = \"/dev/no-camera\"\n[odometry]\n"
             "can_interface = \"nocan7\"\n[telemetry]\nsocket = \"" +
                 socket_ + "\"\n");
  NotifySocket manager(notify_);
  Process daemon({ZENITHD, "--config", file_}, output_, errors_, {{"NOTIFY_SOCKET", notify_}});
  ASSERT_TRUE(manager.heard("READY=1", kLimit_s));
  EXPECT_TRUE(logged("camera: "));
  EXPECT_TRUE(logged("CAN bus: "));
  EXPECT_TRUE(manager.heard("STATUS=starting: no camera", kLimit_s));
  LineReader reader(socket_);
  const auto health = next(reader, "health");
  EXPECT_EQ(health["state"], "starting");
  EXPECT_EQ(health["camera"]["up"], false);
  EXPECT_EQ(health["can"]["up"], false);
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(kLimit_s), 0) << read_text(errors_);
}

TEST_F(DaemonTest, ChecksAFileAndSaysWhatItWouldDo) {
  std::string said;
  configure("");
  EXPECT_EQ(run({ZENITHD_SIM, "--config", file_, "--check"}, said), 0);
  EXPECT_THAT(said, AllOf(HasSubstr("simulated robot r1 in the world corridor-rooms"),
                          HasSubstr("200 particles"), HasSubstr(socket_)));
  // The folder of the map: the configured one, and who has it.
  const std::string maps = (folder_.path() / "maps").string();
  configure("[map]\nfolder = \"" + maps + "\"\n");
  EXPECT_EQ(run({ZENITHD_SIM, "--config", file_, "--check"}, said), 0);
  EXPECT_THAT(said, HasSubstr("map kept:  " + maps + ": it is not there"));
  fs::create_directory(maps);
  {
    storage::FolderLock lock;
    ASSERT_TRUE(lock.take(maps, {7, "zenithd", "bert"}).ours());
    EXPECT_EQ(run({ZENITHD_SIM, "--config", file_, "--check"}, said), 0);
    EXPECT_THAT(said, AllOf(HasSubstr("map kept:  " + maps + ", of "), HasSubstr(" MB free"),
                            HasSubstr("in use by zenithd (pid 7, robot bert)")));
  }
  EXPECT_EQ(run({ZENITHD, "--config", file_, "--check"}, said), 2);
  EXPECT_THAT(said, HasSubstr("zenithd-sim"));
  configure("[simulation]\nrobot = \"r9\"\n");
  EXPECT_EQ(run({ZENITHD_SIM, "--config", file_, "--check"}, said), 2);
  EXPECT_THAT(said, HasSubstr("'r9' is not in the world corridor-rooms; there are r1, r2"));
  configure("[camera]\n");  // a section twice
  EXPECT_EQ(run({ZENITHD_SIM, "--config", file_}, said), 2);
  EXPECT_THAT(said, HasSubstr("zenith.toml:9: "));
}

// The key that the radio would use, by --check, at the start and at SIGHUP.
TEST_F(DaemonTest, ReadsTheFleetKeyAgain) {
  const std::string radio = "[radio]\nkey_file = \"fleet.key\"\ninterface = \"lo\"\nown_port = 0\n";
  const fs::path key_file = folder_.path() / "fleet.key";
  std::string said;
  configure("");
  EXPECT_EQ(run({ZENITHD_SIM, "--config", file_, "--check"}, said), 0);
  EXPECT_THAT(said, HasSubstr("fleet key: none, the radio is off: radio.key_file names no key"));
  configure(radio);
  EXPECT_EQ(run({ZENITHD_SIM, "--config", file_, "--check"}, said), 2);
  EXPECT_THAT(said, AllOf(HasSubstr("No such file"), HasSubstr("zenith key new")));
  ASSERT_TRUE(create_fleet_key(key_file).ok());
  fs::permissions(key_file, fs::perms(0644));
  EXPECT_EQ(run({ZENITHD_SIM, "--config", file_, "--check"}, said), 2);
  EXPECT_THAT(said, HasSubstr("chmod 640"));
  fs::permissions(key_file, fs::perms(0600));
  const std::string first = keys_text(*read_fleet_keys(key_file));
  EXPECT_EQ(run({ZENITHD_SIM, "--config", file_, "--check"}, said), 0);
  EXPECT_THAT(said, HasSubstr("fleet key: " + first + ", from " + key_file.string()));

  NotifySocket manager(notify_);
  Process daemon({ZENITHD_SIM, "--config", file_}, output_, errors_, {{"NOTIFY_SOCKET", notify_}});
  ASSERT_TRUE(manager.heard("READY=1", kLimit_s)) << read_text(errors_);
  EXPECT_TRUE(logged("radio: fleet key " + first));
  fs::permissions(key_file, fs::perms(0644));
  daemon.send(SIGHUP);
  ASSERT_TRUE(manager.heard("READY=1", kLimit_s));
  EXPECT_TRUE(logged("the fleet key stays as it was; its file is wrong:"));
  EXPECT_TRUE(logged("chmod 640"));
  fs::permissions(key_file, fs::perms(0600));
  ASSERT_TRUE(rotate_fleet_key(key_file).ok());
  configure(radio + "[slam]\nparticels = 3\n");  // one wrong file does not hold up the other
  daemon.send(SIGHUP);
  ASSERT_TRUE(manager.heard("READY=1", kLimit_s));
  EXPECT_TRUE(logged("the configuration stays as it was"));
  const std::string second = keys_text(*read_fleet_keys(key_file));
  EXPECT_THAT(second, HasSubstr("; " + first + " only opens"));
  EXPECT_TRUE(logged("fleet key read again: " + second));
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(kLimit_s), 0) << read_text(errors_);
}

// What fixes memory and time of the running daemon.
TEST_F(DaemonTest, ItsHeapAndItsRealtimeAreLimited) {
  NotifySocket manager(notify_);
  write_text(file_,
             "[camera]\ndevice = \"/dev/no-camera\"\n[odometry]\ncan_interface = "
             "\"nocan7\"\n[telemetry]\nsocket = \"" +
                 socket_ + "\"\n[record]\nenabled = false\n");
  Process real({ZENITHD, "--config", file_}, output_, errors_, {{"NOTIFY_SOCKET", notify_}});
  ASSERT_TRUE(manager.heard("READY=1", kLimit_s)) << read_text(errors_);
  const std::string process = "/proc/" + std::to_string(real.pid());
  EXPECT_THAT(read_text(process + "/limits"),
              ContainsRegex("Max realtime timeout +3000000 +6000000 +us"));
  // One heap: threads have no arenas of their own, whose address space glibc reserves at once.
  std::istringstream maps(read_text(process + "/maps"));
  for (std::string line; std::getline(maps, line);) {
    unsigned long long begin = 0;
    unsigned long long end = 0;
    char rights[8] = "";
    ASSERT_EQ(std::sscanf(line.c_str(), "%llx-%llx %7s", &begin, &end, rights), 3) << line;
    const bool reserved = std::string(rights) == "---p" && line.find('/') == std::string::npos;
    EXPECT_FALSE(reserved && end - begin > 16u * 1024 * 1024) << line;
  }
  real.send(SIGTERM);
  EXPECT_EQ(real.wait(kLimit_s), 0) << read_text(errors_);
}

// One program writes a folder of maps: a second daemon drives without, and says so, until the first
// one has gone; an import is refused.
TEST_F(DaemonTest, AFolderOfMapsHasOneUser) {
  const fs::path maps = folder_.path() / "maps";
  fs::create_directory(maps);
  const std::string common =
      "[record]\nenabled = false\n[map]\ninterval_s = 1\nfolder = \"" + maps.string() + "\"\n";
  const std::string second_file = (folder_.path() / "second.toml").string();
  const std::string second_socket = (folder_.path() / "second.sock").string();
  configure(common);
  std::string text = read_text(file_);
  text.replace(text.find(socket_), socket_.size(), second_socket);
  text.replace(text.find("ada"), 3, "bob");
  write_text(second_file, text);

  Process first({ZENITHD_SIM, "--config", file_}, output_, errors_);
  ASSERT_TRUE(wait_until(kLimit_s, [&] { return fs::exists(maps / "map-0.zenmap"); }))
      << read_text(errors_);
  // Whoever tidies up does not let a second one in.
  fs::remove(maps / "lock");
  EXPECT_TRUE(wait_until(kLimit_s, [&] { return storage::user_of(maps).has_value(); }));
  EXPECT_TRUE(logged("was removed, and is made anew"));
  const std::string second_log = (folder_.path() / "second.log").string();
  Process second({ZENITHD_SIM, "--config", second_file}, output_ + "2", second_log);
  const std::string who = "zenithd-sim (pid " + std::to_string(first.pid()) + ", robot ada)";
  EXPECT_TRUE(wait_until(kLimit_s, [&] {
    return read_text(second_log)
               .find("the map cannot be kept: " + maps.string() + " is in use by " + who) !=
           std::string::npos;
  })) << read_text(second_log);
  std::unique_ptr<LineReader> reader;
  ASSERT_TRUE(wait_until(kLimit_s, [&] {
    reader = std::make_unique<LineReader>(second_socket);
    return reader->connected();
  }));
  EXPECT_THAT(next(*reader, "stored_map")["error"].get<std::string>(), HasSubstr(who));
  nlohmann::json health = next(*reader, "health");
  for (int i = 0; i < 60 && health["state"] != "degraded"; ++i) health = next(*reader, "health");
  EXPECT_EQ(health["reason"], "the map cannot be kept");
  EXPECT_FALSE(fs::exists(maps / "session-1-0.zenmap"));

  const fs::path copy = folder_.path() / "copy.zenmap";
  fs::copy_file(maps / "map-0.zenmap", copy);
  std::string said;
  const auto import = [&] {
    Process command({ZENITH_TOOL, "map", "import", copy, maps}, output_ + "3", errors_ + "3");
    const int code = command.wait(kLimit_s);
    said = read_text(output_ + "3") + read_text(errors_ + "3");
    return code;
  };
  EXPECT_NE(import(), 0);
  EXPECT_THAT(said, HasSubstr(who));

  first.send(SIGTERM);
  EXPECT_EQ(first.wait(kLimit_s), 0) << read_text(errors_);
  EXPECT_TRUE(wait_until(kLimit_s, [&] { return fs::exists(maps / "session-1-0.zenmap"); }))
      << read_text(second_log);
  second.send(SIGTERM);
  EXPECT_EQ(second.wait(kLimit_s), 0) << read_text(second_log);
  EXPECT_EQ(import(), 0) << said;
  EXPECT_TRUE(fs::exists(maps / "map-0.zenmap.left"));
}

TEST_F(DaemonTest, ExplainsItself) {
  std::string said;
  EXPECT_EQ(run({ZENITHD, "--help"}, said), 0);
  EXPECT_THAT(said, AllOf(HasSubstr("--print-config"), HasSubstr("SIGHUP")));
  EXPECT_EQ(run({ZENITHD, "--version"}, said), 0);
  EXPECT_THAT(said, HasSubstr(ZENITH_VERSION));
  EXPECT_EQ(run({ZENITHD}, said), 2);
  EXPECT_THAT(said, HasSubstr("--config FILE is missing"));
  EXPECT_EQ(run({ZENITHD, "--konfig", "x"}, said), 2);
  EXPECT_THAT(said, HasSubstr("unknown argument '--konfig'"));
  EXPECT_EQ(run({ZENITHD, "--config"}, said), 2);
  EXPECT_EQ(run({ZENITHD, "--print-config"}, said), 0);
  write_text(file_, said);
  EXPECT_EQ(run({ZENITHD, "--config", file_, "--check"}, said), 0);
}

}  // namespace
}  // namespace zenith
