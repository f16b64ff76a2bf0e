// How the daemon ends: with its map on the disk, whatever a card, a driver or an error does.
// Each daemon is a process of its own, with a camera that the test holds up.

#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/daemon/daemon.h"
#include "platform/daemon/daemon_threads.h"
#include "platform/linux/log.h"
#include "platform/linux/signals.h"
#include "platform/storage/map_store.h"
#include "tests/memory/heap_guard.h"
#include "tests/system/process.h"
#include "tests/unit/daemon/fake_devices.h"
#include "tests/unit/tools/temporary_folder.h"

namespace {

std::atomic<int> g_sync_ms = 0;
std::atomic<int> g_syncs = 0;  // begun

}  // namespace

// The card of this program: as slow as the test wants it.
extern "C" int fsync(int file) {
  ++g_syncs;
  const zenith::Duration time = {std::int64_t{1'000'000} * g_sync_ms.load()};
  if (time.ns > 0) zenith::sleep_until(zenith::monotonic_now() + time);
  return static_cast<int>(::syscall(SYS_fsync, file));
}

namespace zenith {
namespace {

using testing::HasSubstr;

constexpr double kLimit_s = 120.0;  // what is waited for is a state

// A driver that hangs where the test says.
class HangingCamera final : public Camera {
 public:
  explicit HangingCamera(std::unique_ptr<Camera> camera) : camera_(std::move(camera)) {}

  Status open() override {
    hang_if(hangs_in_open);
    return camera_->open();
  }
  void close() override {
    hang_if(hangs_in_close);
    camera_->close();
  }
  CameraWait wait(Duration timeout, CameraFrame& out) override {
    while (spins_in_wait.load(std::memory_order_relaxed)) {
    }
    const CameraWait result = camera_->wait(timeout, out);
    if (result == CameraWait::kFrame) ++frames;
    return result;
  }
  std::string description() const override { return camera_->description(); }
  Duration period() const override { return camera_->period(); }
  const char* lost_reason() const override { return camera_->lost_reason(); }
  const CameraCounters& counters() const override { return camera_->counters(); }

  std::atomic<bool> hangs_in_open = false;
  std::atomic<bool> hangs_in_close = false;
  std::atomic<bool> spins_in_wait = false;
  std::atomic<bool> hangs = false;
  std::atomic<int> frames = 0;

 private:
  void hang_if(const std::atomic<bool>& wanted) {
    while (wanted.load()) {
      hangs.store(true);
      sleep_until(monotonic_now() + Duration{10'000'000});
    }
  }

  const std::unique_ptr<Camera> camera_;
};

// Ends the driving before the devices go.
class DrivenWorld final : public DeviceWorld {
 public:
  explicit DrivenWorld(FakeRobot& robot) : robot_(robot) { robot_.drive(); }
  ~DrivenWorld() override { robot_.stop(); }

 private:
  FakeRobot& robot_;
};

FakeRobot* g_robot = nullptr;
HangingCamera* g_camera = nullptr;
std::atomic<bool> g_made = false;  // both are there

Result<Devices> make_driven_devices(const DaemonConfig& /*config*/) {
  auto camera = std::make_unique<HangingCamera>(std::move(g_robot->devices.camera));
  g_camera = camera.get();
  g_robot->devices.camera = std::move(camera);
  g_robot->devices.world = std::make_unique<DrivenWorld>(*g_robot);
  g_made.store(true);
  return std::move(g_robot->devices);
}

class DaemonEnd : public testing::Test {
 protected:
  DaemonEnd() {
    config_.slam.particles = 32;
    config_.realtime = {0, "", false, false};
    config_.telemetry.enabled = false;
    config_.record.enabled = false;
    config_.map = {folder_.path().string(), 3600.0};
  }

  // Runs the daemon in a process of its own, beside `direct`; returns its exit code, or -1 when it
  // does not end.
  int run(const std::function<void()>& direct) {
    const pid_t child = ::fork();
    if (child == 0) {
      ::dup2(::open(log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
      FakeRobot robot;
      g_robot = &robot;
      Signals signals;
      if (!signals.open()) ::_exit(90);
      std::thread director([&] {
        if (!wait_until(kLimit_s, [] { return g_made.load(); })) ::_exit(91);
        direct();
      });
      const int code = run_daemon(config_, "test.toml", make_driven_devices, signals);
      director.join();
      ::_exit(code);
    }
    int status = 0;
    const bool ended =
        wait_until(2 * kLimit_s, [&] { return ::waitpid(child, &status, WNOHANG) == child; });
    if (!ended) {
      ::kill(child, SIGKILL);
      ::waitpid(child, nullptr, 0);
      return -1;
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  // --- for the director, in the child: what does not come ends the child
  static void need(const std::function<bool()>& holds, int code) {
    if (!wait_until(kLimit_s, holds)) ::_exit(code);
  }
  // The first checkpoint is there, and since then there is more to write.
  void wait_for_more_than_the_first_checkpoint() const {
    need([&] { return std::filesystem::exists(folder_.path() / "map-0.zenmap"); }, 92);
    const int frames = g_camera->frames.load();
    need([&] { return g_camera->frames.load() > frames + 20; }, 93);
  }
  static void ask_to_stop() { ::kill(::getpid(), SIGTERM); }

  std::uint64_t checkpoint() const {
    storage::DiskFolder disk(folder_.path().string());
    storage::MapStore store(disk);
    const auto loaded = store.load();
    return loaded.map ? loaded.map->head.checkpoint : 0;
  }
  std::string log() const { return tools::read_text(log_); }

  const tools::TemporaryFolder folder_;
  const tools::TemporaryFolder beside_;
  const std::string log_ = (beside_.path() / "log.txt").string();
  DaemonConfig config_;
};

TEST_F(DaemonEnd, ASlowCardGetsItsLastCheckpoint) {
  config_.map.interval_s = 1.0;
  const std::string manager_path = (beside_.path() / "notify.sock").string();
  NotifySocket manager(manager_path);
  ::setenv("NOTIFY_SOCKET", manager_path.c_str(), 1);
  const int code = run([] {
    g_sync_ms.store(2000);
    need([] { return g_syncs.load() > 0; }, 94);
    ask_to_stop();  // amid the first one's first sync
  });
  ::unsetenv("NOTIFY_SOCKET");
  EXPECT_EQ(code, 0) << log();
  EXPECT_GE(checkpoint(), 1u) << log();
  EXPECT_TRUE(manager.heard("STOPPING=1", 1.0));
  EXPECT_TRUE(manager.heard("EXTEND_TIMEOUT_USEC=", 1.0));
}

TEST_F(DaemonEnd, ACameraThatHangsInOpenCostsNeitherCheckpointNorExitCode) {
  const int code = run([this] {
    wait_for_more_than_the_first_checkpoint();
    g_camera->hangs_in_open.store(true);
    g_robot->camera->set_plugged(false);
    need([] { return g_camera->hangs.load(); }, 95);
    ask_to_stop();
  });
  EXPECT_EQ(code, 0) << log();
  EXPECT_EQ(checkpoint(), 2u) << log();
  EXPECT_THAT(log(), HasSubstr("left behind, for it did not end in time: zen-keeper"));
}

TEST_F(DaemonEnd, ACameraThatHangsInCloseCostsNeither) {
  const int code = run([this] {
    wait_for_more_than_the_first_checkpoint();
    g_camera->hangs_in_close.store(true);
    ask_to_stop();
  });
  EXPECT_EQ(code, 0) << log();
  EXPECT_EQ(checkpoint(), 2u) << log();
  EXPECT_THAT(log(), HasSubstr("left behind"));
}

TEST_F(DaemonEnd, AnErrorOfTheMainThreadEndsAllInGoodOrder) {
  if (!HeapGuard::works()) GTEST_SKIP() << "a sanitizer has the heap";
  const int code = run([this] {
    wait_for_more_than_the_first_checkpoint();
    fail_next_new(::getpid());
  });
  EXPECT_EQ(code, 1) << log();
  EXPECT_EQ(checkpoint(), 2u) << log();
  EXPECT_THAT(log(), HasSubstr("ending because of an error: std::bad_alloc"));
}

TEST_F(DaemonEnd, ARunawayRealtimeThreadLosesItsPriorityAndTheDaemonEnds) {
  const sched_param wanted = {.sched_priority = 1};
  if (::sched_setscheduler(0, SCHED_FIFO, &wanted) != 0) GTEST_SKIP() << "no SCHED_FIFO here";
  const sched_param none = {};
  ASSERT_EQ(::sched_setscheduler(0, SCHED_OTHER, &none), 0);
  config_.realtime.priority = 1;
  const int code = run([this] {
    wait_for_more_than_the_first_checkpoint();
    g_camera->spins_in_wait.store(true);
  });
  EXPECT_EQ(code, 1) << log();
  EXPECT_EQ(checkpoint(), 2u) << log();
  EXPECT_THAT(log(), HasSubstr("computed for 3 s without a pause and lost its realtime priority"));
  EXPECT_THAT(log(), HasSubstr("left behind, for it did not end in time: zen-perception"));
}

TEST(DaemonThreads, AreToldToStopWhateverWayTheScopeIsLeft) {
  std::atomic<int> ended = 0;
  const auto body = [&ended](const std::atomic<bool>& stop) {
    while (!stop.load()) sleep_until(monotonic_now() + Duration{1'000'000});
    ++ended;
  };
  try {
    DaemonThreads threads;
    Report report;
    ASSERT_TRUE(threads.start({}, "one", body, report));
    ASSERT_TRUE(threads.start({}, "two", body, report));
    EXPECT_EQ(threads.running(), "one, two");
    throw std::runtime_error("the main thread's");
  } catch (const std::runtime_error&) {
  }
  EXPECT_EQ(ended.load(), 2);
}

TEST(DaemonThreads, AnErrorThatEndsOneIsSeen) {
  DaemonThreads threads;
  Report report;
  EXPECT_TRUE(threads.ended("bad")) << "never started";
  ASSERT_TRUE(threads.start(
      {}, "bad", [](const std::atomic<bool>&) { throw std::runtime_error("of the test"); },
      report));
  EXPECT_TRUE(wait_until(kLimit_s, [&] { return threads.failed(); }));
  EXPECT_TRUE(wait_until(kLimit_s, [&] { return threads.ended("bad"); }));
}

}  // namespace
}  // namespace zenith
