// `zenith record` of a running zenithd-sim, each a process of its own.

#include <sys/socket.h>

#include <array>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "platform/linux/local_socket.h"
#include "platform/recording/layout.h"
#include "platform/recording/recording.h"
#include "tests/support/figure.h"
#include "tests/support/line_reader.h"
#include "tests/support/patience.h"
#include "tests/system/process.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using tools::edit_text;
using tools::read_text;
using tools::write_text;

constexpr double kLimit_s = kPatience_s;

class RecordSystemTest : public testing::Test {
 protected:
  void SetUp() override {
    write_text(config_,
               "[robot]\nname = \"ada\"\n[camera]\ndriver = \"simulated\"\n[odometry]\n"
               "driver = \"simulated\"\npatience_s = 1\n[telemetry]\nsocket = \"" +
                   telemetry_ + "\"\n[record]\nframes = 8\nsocket = \"" + socket_ +
                   "\"\n[simulation]\nframe_rate_hz = 5\n[slam]\nparticles = 100\n");
  }

  std::unique_ptr<Process> start_daemon() {
    NotifySocket manager(notify_);
    auto daemon = std::make_unique<Process>(
        std::vector<std::string>{ZENITHD_SIM, "--config", config_}, path("daemon.txt"),
        path("daemon-errors.txt"), std::vector<Environment>{{"NOTIFY_SOCKET", notify_}});
    EXPECT_TRUE(manager.heard("READY=1", kLimit_s)) << read_text(path("daemon-errors.txt"));
    EXPECT_TRUE(wait_until(kLimit_s, [&] { return frames_seen() >= 1; }));
    return daemon;
  }
  // Of the map, by the daemon's telemetry.
  std::uint64_t frames_seen() const { return line("health")["map"]["frames"]; }
  // A new reader's first line of this type.
  nlohmann::json line(const std::string& type) const {
    LineReader reader(telemetry_);
    for (int i = 0; i < 200; ++i) {
      const auto json = nlohmann::json::parse(reader.next(), nullptr, false);
      if (json.is_object() && json.value("type", "") == type) return json;
    }
    ADD_FAILURE() << "no line of type " << type;
    return {};
  }
  // Missed ones that the perception thread's own work explains.
  std::uint64_t own_misses() const {
    const auto deadlines = line("deadlines");
    return deadlines["missed"].get<std::uint64_t>() - deadlines["explained"].get<std::uint64_t>();
  }

  std::unique_ptr<Process> start_record(std::vector<std::string> more) {
    std::vector<std::string> words = {ZENITH_TOOL, "record", out_};
    words.insert(words.end(), more.begin(), more.end());
    return std::make_unique<Process>(words, path("record.txt"), path("record-errors.txt"));
  }
  std::unique_ptr<Process> record_from_daemon(std::vector<std::string> more) {
    more.insert(more.end(), {"--socket", socket_});
    return start_record(std::move(more));
  }
  std::string said() const {
    return read_text(path("record.txt")) + read_text(path("record-errors.txt"));
  }
  // Frames that are listed, in a folder that may still grow.
  std::size_t listed() const {
    const auto frames = read_frame_list(layout::frame_list(out_));
    return frames.ok() ? frames->size() : 0;
  }
  bool wait_for_frames(std::size_t count) const {
    return wait_until(kLimit_s, [&] { return listed() >= count; });
  }
  // Reads all of it; returns how many frames had wheels.
  int read_back(int& frames) const {
    frames = 0;
    int with_wheels = 0;
    auto recording = Recording::open(out_, {});
    EXPECT_TRUE(recording.ok()) << recording.error().message;
    if (!recording.ok()) return 0;
    SourceFrame frame;
    while (true) {
      const auto more = (*recording)->next(frame);
      EXPECT_TRUE(more.ok()) << more.error().message;
      if (!more.ok() || !*more) break;
      ++frames;
      with_wheels += !frame.wheels.empty();
    }
    return with_wheels;
  }

  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  tools::TemporaryFolder folder_;
  const std::string config_ = path("zenith.toml");
  const std::string telemetry_ = path("telemetry.sock");
  const std::string socket_ = path("record.sock");
  const std::string notify_ = path("notify.sock");
  const std::string out_ = path("rec");
};

TEST_F(RecordSystemTest, TheRunningRobotIsRecordedAndTheRecordingReplays) {
  const auto daemon = start_daemon();
  const std::uint64_t misses = own_misses();
  const auto faults = line("health")["page_faults"];
  const auto record = record_from_daemon({"--duration", "4"});
  EXPECT_EQ(record->wait(kLimit_s), 0) << said();
  EXPECT_EQ(own_misses(), misses) << "a step computed for longer because it was recorded";
  print_figure("record: page faults of the perception thread before %s, after %s",
               faults.dump().c_str(), line("health")["page_faults"].dump().c_str());
  EXPECT_THAT(said(), HasSubstr("the duration is reached"));
  int frames = 0;
  const int with_wheels = read_back(frames);
  EXPECT_GE(frames, 5);
  EXPECT_GE(with_wheels, frames - 2) << "frames and wheels are of one clock and one time";

  Process replay({ZENITH_TOOL, "replay", out_, "--out", path("map")}, path("replay.txt"),
                 path("replay-errors.txt"));
  EXPECT_EQ(replay.wait(kLimit_s), 0) << read_text(path("replay-errors.txt"));
  EXPECT_TRUE(fs::exists(path("map") + "/map.png"));
  daemon->send(SIGTERM);
  EXPECT_EQ(daemon->wait(kLimit_s), 0);
  EXPECT_FALSE(fs::exists(socket_));
}

// Two computers that were started at different times: one of the recorders in a time namespace.
TEST_F(RecordSystemTest, RecordingsOfTwoComputersAreReplayedOnOneClock) {
  const std::vector<std::string> elsewhere = {"unshare", "-T",         "--fork", "--monotonic",
                                              "5000",    "--boottime", "5000"};
  const auto with = [](std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  Process probe(with(elsewhere, {"true"}), path("probe.txt"), path("probe-errors.txt"));
  if (probe.wait(kLimit_s) != 0) {
    GTEST_SKIP() << "no time namespaces here: " << read_text(path("probe-errors.txt"));
  }
  std::vector<std::string> outs;
  std::vector<std::unique_ptr<Process>> recorders;
  for (const char* robot : {"r1", "r2"}) {
    const std::string config = path(std::string(robot) + ".toml");
    write_text(config, read_text(config_));
    edit_text(config, "[simulation]\n", std::string("[simulation]\nrobot = \"") + robot + "\"\n");
    outs.push_back(path(robot));
    const std::vector<std::string> record = {ZENITH_TOOL, "record",     outs.back(), "--config",
                                             config,      "--duration", "4"};
    recorders.push_back(std::make_unique<Process>(
        recorders.empty() ? record : with(elsewhere, record), path("out.txt"), path("err.txt")));
  }
  for (const auto& recorder : recorders) {
    EXPECT_EQ(recorder->wait(kLimit_s), 0) << read_text(path("err.txt"));
  }
  const auto first = read_frame_list(layout::frame_list(outs[0]));
  const auto second = read_frame_list(layout::frame_list(outs[1]));
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_GT((second->front().stamp - first->front().stamp).seconds(), 4900.0);
  Process replay({ZENITH_TOOL, "replay", outs[0], outs[1], "--out", path("map")},
                 path("replay.txt"), path("replay-errors.txt"));
  EXPECT_EQ(replay.wait(kLimit_s), 0) << read_text(path("replay-errors.txt"));
  const std::string told = read_text(path("replay.txt"));
  EXPECT_THAT(told, HasSubstr("clocks: on wall time by clock.csv"));
  const std::size_t common = told.find("r1 and r2: ");
  ASSERT_NE(common, std::string::npos) << told;
  EXPECT_GT(std::stod(told.substr(common + 11)), 1.0) << told;
}

TEST_F(RecordSystemTest, WhatAKilledRecorderWroteIsARecordingAndTheRobotGoesOn) {
  const auto daemon = start_daemon();
  auto record = record_from_daemon({});
  ASSERT_TRUE(wait_for_frames(5)) << said();
  record->send(SIGKILL);
  EXPECT_EQ(record->wait(kLimit_s), 128 + SIGKILL);
  int frames = 0;
  read_back(frames);
  EXPECT_GE(frames, 5);

  const std::uint64_t seen = frames_seen();
  EXPECT_TRUE(wait_until(kLimit_s, [&] { return frames_seen() > seen + 3; }));
  fs::remove_all(out_);
  record = record_from_daemon({});
  ASSERT_TRUE(wait_for_frames(3)) << said();
  record->send(SIGINT);
  EXPECT_EQ(record->wait(kLimit_s), 0) << said();
  EXPECT_THAT(said(), HasSubstr("ended: stopped"));
}

TEST_F(RecordSystemTest, ASlowRecorderLosesFramesAndNobodyElseDoes) {
  const auto daemon = start_daemon();
  const auto record = record_from_daemon({});
  ASSERT_TRUE(wait_for_frames(2)) << said();
  record->send(SIGSTOP);
  const std::uint64_t seen = frames_seen();
  // More than the tap's eight slots and the socket hold.
  EXPECT_TRUE(wait_until(kLimit_s, [&] { return frames_seen() > seen + 25; }));
  record->send(SIGCONT);
  ASSERT_TRUE(wait_for_frames(12)) << said();
  record->send(SIGINT);
  EXPECT_EQ(record->wait(kLimit_s), 0) << said();
  EXPECT_THAT(said(), HasSubstr("frames are missing: this computer or its disk was too slow"));
  int frames = 0;
  read_back(frames);
  EXPECT_GE(frames, 12);
}

TEST_F(RecordSystemTest, TheDaemonsEndEndsTheRecording) {
  const auto daemon = start_daemon();
  const auto record = record_from_daemon({});
  ASSERT_TRUE(wait_for_frames(2)) << said();
  daemon->send(SIGTERM);
  EXPECT_EQ(daemon->wait(kLimit_s), 0);
  EXPECT_EQ(record->wait(kLimit_s), 0) << said();
  EXPECT_THAT(said(), HasSubstr("ended: the daemon ends"));
}

TEST_F(RecordSystemTest, ManyWhoConnectDoNotDisturb) {
  const auto daemon = start_daemon();
  const std::uint64_t misses = own_misses();
  const std::uint64_t seen = frames_seen();
  std::vector<UniqueFd> held;
  for (int i = 0; i < 2000; ++i) {
    UniqueFd fd = connect_local(socket_, SOCK_STREAM).fd;
    if (fd.is_open() && i % 7 == 0) held.push_back(std::move(fd));
    if (held.size() > 50) held.clear();
  }
  EXPECT_TRUE(wait_until(kLimit_s, [&] { return frames_seen() > seen + 10; }));
  EXPECT_EQ(own_misses(), misses);
  // One that only holds its place is let go when it takes nothing; here it leaves by itself.
  held.clear();
  for (int i = 0; i < 100 && listed() < 2; ++i) {
    fs::remove_all(out_);
    const auto record = record_from_daemon({"--duration", "1"});
    if (record->wait(kLimit_s) != 0) {
      EXPECT_THAT(said(), HasSubstr("is recording")) << i;
    }
  }
  EXPECT_GE(listed(), 2u) << said();
}

TEST_F(RecordSystemTest, DevicesAreRecordedDirectlyOnlyWithoutADaemon) {
  auto record = start_record({"--config", config_, "--duration", "4"});
  EXPECT_EQ(record->wait(kLimit_s), 0) << said();
  int frames = 0;
  EXPECT_GE(read_back(frames), 1);
  EXPECT_GE(frames, 3);

  record = start_record({"--config", config_});
  EXPECT_EQ(record->wait(kLimit_s), 1);
  EXPECT_THAT(said(), HasSubstr("never overwritten"));

  fs::remove_all(out_);
  record = record_from_daemon({});
  EXPECT_EQ(record->wait(kLimit_s), 1);
  EXPECT_THAT(said(), HasSubstr("no running zenithd was found"));
  EXPECT_FALSE(fs::exists(out_));

  const auto daemon = start_daemon();
  record = start_record({"--config", config_});
  EXPECT_EQ(record->wait(kLimit_s), 1);
  EXPECT_THAT(said(), HasSubstr("zenithd is running"));
  EXPECT_FALSE(fs::exists(out_));
}

// A daemon that plays a recording is recorded as that robot, whatever its own file says of the
// base.
TEST_F(RecordSystemTest, ARecordingThatIsPlayedKeepsItsRobot) {
  auto record = start_record({"--config", config_, "--duration", "4"});
  ASSERT_EQ(record->wait(kLimit_s), 0) << said();
  const std::string first = path("first");
  fs::rename(out_, first);
  write_text(config_, "[camera]\ndriver = \"replay\"\n[replay]\nfolder = \"" + first +
                          "\"\nloop = true\n[odometry]\ndriver = \"replay\"\ncodec = \"odrive\"\n"
                          "[telemetry]\nsocket = \"" +
                          telemetry_ + "\"\n[record]\nsocket = \"" + socket_ + "\"\n");
  const auto daemon = start_daemon();
  record = record_from_daemon({"--duration", "3"});
  EXPECT_EQ(record->wait(kLimit_s), 0) << said();
  int frames = 0;
  EXPECT_GE(read_back(frames), 3);
  const auto robot = read_robot_file(layout::robot(out_));
  ASSERT_TRUE(robot.ok()) << robot.error().message;
  EXPECT_EQ(robot->odometry.kind, WheelCodecKind::kAgilexV2);
}

}  // namespace
}  // namespace zenith
