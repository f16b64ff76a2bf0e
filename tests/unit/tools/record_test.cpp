#include "tools/record/record.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <atomic>
#include <deque>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/recording/recording.h"
#include "tests/unit/tools/small_recording.h"
#include "tests/unit/tools/temporary_folder.h"
#include "tools/record/frame_store.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A source without a robot: each take() hands on the next frame with its wheels.
class FakeSource final : public RecordSource {
 public:
  explicit FakeSource(int frames) : frames_(frames) {
    hello_.config = small_robot();
    hello_.can_interface = "can0";
    end_.why = "the daemon ends";
  }
  const tap::Hello& robot() const override { return hello_; }
  Result<bool> take(Duration, RecordSink& sink) override {
    if (finished_ || next_ == frames_) return false;
    if (next_ == fails_at) return Error{"the cable is out"};
    for (int i = 0; i < 6; ++i) {
      const Time stamp{1'000'000'000 + (5 * next_ + i) * 20'000'000LL + i};
      const CanFrame frame = agilex_v2::encode_odometer(stamp, {10 * next_, 11 * next_});
      sink.can({&frame, 1});
    }
    const auto pixels = small_pixels(next_);
    sink.frame({stamp_of(next_), sequence_of(next_), 32, 24}, {pixels.data(), 32, 24, 32});
    sink.pose({stamp_of(next_), small_pose(next_)});
    ++next_;
    return true;
  }
  void finish() override { finished_ = true; }
  tap::End end() const override { return end_; }
  std::string description() const override { return "fake"; }

  std::function<Time(int)> stamp_of = small_stamp;
  std::function<std::uint64_t(int)> sequence_of = [](int i) {
    return static_cast<std::uint64_t>(i);
  };
  int fails_at = -1;
  tap::Hello hello_;
  tap::End end_;

 private:
  const int frames_;
  int next_ = 0;
  bool finished_ = false;
};

class RecordTest : public testing::Test {
 protected:
  RecordTest() {
    plan_.out = folder_.path() / "rec";
    plan_.keep_free_mb = 0.0;
  }
  Result<RecordFigures> run(FakeSource& source) {
    return record(
        plan_, source, [] { return false; }, [this](const RecordFigures& f) { told_ = f; });
  }

  TemporaryFolder folder_;
  RecordPlan plan_;
  RecordFigures told_;
};

TEST_F(RecordTest, WhatComesIsARecordingThatReadsBack) {
  FakeSource source(10);
  const auto figures = run(source);
  ASSERT_TRUE(figures.ok()) << figures.error().message;
  EXPECT_EQ(figures->frames, 10u);
  EXPECT_EQ(figures->can, 60u);
  EXPECT_EQ(figures->poses, 10u);
  EXPECT_NEAR(figures->seconds, 0.9, 1e-9);
  EXPECT_EQ(figures->why, "the daemon ends");
  EXPECT_FALSE(figures->failed);
  EXPECT_GT(figures->bytes, 1000u);
  auto recording = Recording::open(plan_.out, {});
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_EQ((*recording)->config().wheels.track_width_m, small_robot().wheels.track_width_m);
  EXPECT_EQ((*recording)->config().lens.fu_px, small_robot().lens.fu_px);
  SourceFrame frame;
  for (int i = 0; i < 10; ++i) {
    const auto more = (*recording)->next(frame);
    ASSERT_TRUE(more.ok() && *more) << i;
    EXPECT_EQ(frame.stamp, small_stamp(i));
    EXPECT_EQ(frame.pixels, small_pixels(i)) << i;
    EXPECT_FALSE(frame.wheels.empty()) << i;
  }
  EXPECT_THAT(read_text(plan_.out / "estimate.tum"), HasSubstr("1.000000007 0.000000"));
  EXPECT_THAT(record_summary(plan_, *figures), HasSubstr("zenith replay"));
}

TEST_F(RecordTest, SaysWhereItsClockLies) {
  // The wall clock is set by 3 s at the fifth look, and the board has slept at the eighth.
  int looks = 0;
  plan_.clocks = [&looks] {
    ++looks;
    const std::int64_t slept = looks >= 8 ? 60'000'000'000 : 0;
    const std::int64_t set = looks >= 5 ? 3'000'000'000 : 0;
    return ClockReading{
        {looks * 100'000'000LL}, {slept}, {1'780'000'000'000'000'000 + slept + set}, looks >= 5};
  };
  FakeSource source(10);
  const auto figures = run(source);
  ASSERT_TRUE(figures.ok()) << figures.error().message;
  EXPECT_TRUE(figures->synchronised);
  const auto recording = Recording::open(plan_.out, {});
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  const auto& clock = (*recording)->clock();
  ASSERT_TRUE(clock);
  ASSERT_EQ(clock->readings().size(), 4u) << "start, step, sleep, end";
  EXPECT_EQ(clock->readings()[1].monotonic.ns, 500'000'000);
  EXPECT_NEAR(clock->stepped().seconds(), 3.0, 1e-9);
  EXPECT_NEAR(clock->slept().seconds(), 60.0, 1e-9);
  EXPECT_EQ(clock->offset({0}).ns, 1'780'000'003'000'000'000);
  EXPECT_THAT(record_summary(plan_, *figures), testing::Not(HasSubstr("NTP")));
}

TEST_F(RecordTest, AClockThatNobodyKeepsIsTold) {
  plan_.clocks = [] { return ClockReading{{1}, {}, {5}, false}; };
  FakeSource source(3);
  const auto figures = run(source);
  ASSERT_TRUE(figures.ok());
  EXPECT_THAT(record_summary(plan_, *figures), HasSubstr("not synchronised (NTP)"));
}

TEST_F(RecordTest, FrameRecordsAreNeverOverwritten) {
  fs::create_directories(folder_.path() / "rec");
  write_text(folder_.path() / "rec" / "mine", "x");
  FakeSource source(3);
  const auto figures = run(source);
  ASSERT_FALSE(figures.ok());
  EXPECT_THAT(figures.error().message, HasSubstr("never overwritten"));
  EXPECT_EQ(entries(folder_.path() / "rec"), 1u);
}

TEST_F(RecordTest, GapsAndDropsAreTold) {
  FakeSource source(10);
  // The robot's driver lost two frames, the daemon dropped three more for us.
  source.sequence_of = [](int i) { return static_cast<std::uint64_t>(i < 5 ? i : i + 5); };
  source.end_.frames_dropped = 3;
  source.end_.can_dropped = 4;
  const auto figures = run(source);
  ASSERT_TRUE(figures.ok());
  EXPECT_EQ(figures->left_out, 3u);
  EXPECT_EQ(figures->passed_over, 2u);
  EXPECT_EQ(figures->can_left_out, 4u);
  EXPECT_THAT(record_summary(plan_, *figures), HasSubstr("3 frames are missing"));
}

TEST_F(RecordTest, AStampThatDoesNotRiseIsLeftOut) {
  FakeSource source(5);
  source.stamp_of = [](int i) { return small_stamp(i == 3 ? 2 : i); };
  const auto figures = run(source);
  ASSERT_TRUE(figures.ok());
  EXPECT_EQ(figures->out_of_order, 1u);
  EXPECT_EQ(figures->frames, 4u);
  EXPECT_TRUE(Recording::open(plan_.out, {}).ok());
}

TEST_F(RecordTest, EndsAtItsDurationAndAtItsSize) {
  FakeSource source(10);
  plan_.duration_s = 0.35;
  auto figures = run(source);
  ASSERT_TRUE(figures.ok());
  EXPECT_EQ(figures->frames, 5u);
  EXPECT_EQ(figures->why, "the duration is reached");
  EXPECT_FALSE(figures->failed);

  fs::remove_all(plan_.out);
  FakeSource again(1000);
  plan_.duration_s = 0.0;
  plan_.max_size_mb = 0.02;
  figures = run(again);
  ASSERT_TRUE(figures.ok());
  EXPECT_EQ(figures->why, "the size is reached");
  EXPECT_LT(figures->frames, 100u);
}

TEST_F(RecordTest, WhatASourceThatFailsHasGivenStays) {
  FakeSource source(10);
  source.fails_at = 6;
  const auto figures = run(source);
  ASSERT_TRUE(figures.ok());
  EXPECT_TRUE(figures->failed);
  EXPECT_EQ(figures->why, "the cable is out");
  EXPECT_EQ(figures->frames, 6u);
  EXPECT_TRUE(Recording::open(plan_.out, {}).ok());
}

TEST_F(RecordTest, ADbcBaseBringsItsFile) {
  FakeSource source(3);
  source.hello_.odometry.kind = WheelCodecKind::kDbc;
  source.hello_.odometry.dbc.file = "/somewhere/else/my.dbc";
  source.hello_.odometry.dbc.left_signal = "WHEEL_L";
  source.hello_.odometry.dbc.right_signal = "WHEEL_R";
  source.hello_.dbc =
      "BO_ 785 WHEELS: 8 B\n SG_ WHEEL_L : 7|32@0- (0.001,0) [0|0] \"m\" X\n"
      " SG_ WHEEL_R : 39|32@0- (0.001,0) [0|0] \"m\" X\n";
  ASSERT_TRUE(run(source).ok());
  EXPECT_EQ(read_text(plan_.out / "base.dbc"), source.hello_.dbc);
  const auto recording = Recording::open(plan_.out, {});
  EXPECT_TRUE(recording.ok()) << recording.error().message;
}

// Whoever listens where the daemon should: one hello, and what comes after it.
class FalseDaemon {
 public:
  FalseDaemon(const std::string& path, std::vector<std::uint8_t> bytes)
      : listener_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address = {};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof(address.sun_path) - 1);
    EXPECT_EQ(::bind(listener_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::listen(listener_.get(), 1), 0);
    thread_ = std::thread([this, bytes = std::move(bytes)] {
      const UniqueFd client(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
      (void)!::send(client.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    });
  }
  ~FalseDaemon() { thread_.join(); }
  FalseDaemon(const FalseDaemon&) = delete;
  FalseDaemon& operator=(const FalseDaemon&) = delete;

 private:
  UniqueFd listener_;
  std::thread thread_;
};

// An interface's name that is a path, with a NUL before the ending that the recorder adds and lines
// that somebody wants in that file.
TEST_F(RecordTest, AnInterfacesNameThatIsAPathReachesNoFile) {
  const fs::path victim = folder_.path() / "victim";
  write_text(victim, "data");
  tap::Hello hello;
  hello.robot = "ada";
  hello.config = small_robot();
  hello.can_interface = victim.string() + std::string("\0\n* * * * * root id\n", 21);
  std::vector<std::uint8_t> bytes = tap::write_hello(hello);
  std::array<std::uint8_t, 64> frame;
  const std::size_t size = tap::write_can(std::vector<CanFrame>(1), frame);
  bytes.insert(bytes.end(), frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(size));
  const std::string socket = (folder_.path() / "record.sock").string();
  const FalseDaemon daemon(socket, bytes);
  const auto source = open_tap_source({socket});
  if (source.ok())
    (void)record(
        plan_, **source, [] { return false; }, [](const auto&) {});
  EXPECT_EQ(read_text(victim), "data");
  ASSERT_FALSE(source.ok());
  EXPECT_THAT(source.error().message, HasSubstr("CAN interface"));
  EXPECT_FALSE(fs::exists(plan_.out));
}

TEST_F(RecordTest, AFrameOfAnotherSizeIsRefusedBeforeThereIsMemoryForIt) {
  tap::Hello hello;
  hello.robot = "ada";
  hello.config = small_robot();
  hello.can_interface = "can0";
  std::vector<std::uint8_t> bytes = tap::write_hello(hello);
  std::array<std::uint8_t, 64> head;
  const std::size_t size = tap::write_frame_head({{1}, 1, 8000, 8000}, head);
  bytes.insert(bytes.end(), head.begin(), head.begin() + static_cast<std::ptrdiff_t>(size));
  const std::string socket = (folder_.path() / "record.sock").string();
  const FalseDaemon daemon(socket, bytes);
  const auto source = open_tap_source({socket});
  std::string why;
  if (source.ok()) {
    const auto figures = record(
        plan_, **source, [] { return false; }, [](const auto&) {});
    ASSERT_TRUE(figures.ok());
    EXPECT_TRUE(figures->failed);
    why = figures->why;
  } else {
    why = source.error().message;  // it came together with the greeting
  }
  EXPECT_THAT(why, HasSubstr("another size"));
}

TEST_F(RecordTest, OnlyAFolderOfItsOwnIsWrittenInto) {
  FakeSource source(3);
  fs::create_directories(plan_.out);
  EXPECT_FALSE(run(source).ok()) << "an empty one may be anybody's";
  EXPECT_EQ(entries(plan_.out), 0u);
}

TEST(FrameStore, ListsInOrderWhicheverThreadIsQuicker) {
  TemporaryFolder folder;
  const RobotFile robot;
  auto writer = RecordingWriter::create(folder.path() / "rec", small_robot(), robot);
  ASSERT_TRUE(writer.ok());
  const auto pixels = small_pixels(1);
  {
    FrameStore store(*writer, 1, 4);
    for (int i = 0; i < 200; ++i) {
      ASSERT_TRUE(store.add({i + 1}, {pixels.data(), 32, 24, 32}, {10'000'000'000}));
    }
    ASSERT_TRUE(store.finish().ok());
    EXPECT_EQ(store.frames(), 200u);
  }
  ASSERT_TRUE(writer->finish().ok());
  const auto listed = read_frame_list(folder.path() / "rec/mav0/cam0/data.csv");
  ASSERT_TRUE(listed.ok()) << listed.error().message;
  EXPECT_EQ(listed->size(), 200u);
}

TEST(FrameStore, AFrameThatCannotBeWrittenIsNotListed) {
  TemporaryFolder folder;
  const RobotFile robot;
  auto writer = RecordingWriter::create(folder.path() / "rec", small_robot(), robot);
  ASSERT_TRUE(writer.ok());
  const auto pixels = small_pixels(1);
  const ImageView image = {pixels.data(), 32, 24, 32};
  FrameStore store(*writer, 1, 2);
  ASSERT_TRUE(store.add({1}, image, {1'000'000'000}));
  ASSERT_TRUE(store.finish().ok());
  fs::remove_all(folder.path() / "rec/mav0/cam0/data");
  ASSERT_TRUE(store.add({2}, image, {1'000'000'000}));
  const Status status = store.finish();
  ASSERT_FALSE(status.ok());
  EXPECT_THAT(status.error().message, HasSubstr("2.png"));
  EXPECT_EQ(store.frames(), 1u);
  EXPECT_FALSE(store.add({3}, image, {0})) << "an error stays";
}

TEST(LineFile, HoldsWholeLinesAlsoWhenTheDiskIsFull) {
  LineFile full(UniqueFd(::open("/dev/full", O_WRONLY | O_CLOEXEC)), "/dev/full");
  full.add("one\n");
  const Status status = full.flush();
  ASSERT_FALSE(status.ok());
  EXPECT_THAT(status.error().message, HasSubstr("ENOSPC"));
  EXPECT_FALSE(full.flush().ok()) << "it is not forgotten";
  EXPECT_FALSE(LineFile(Error{"no such folder"}, "x").flush().ok());

  TemporaryFolder folder;
  const fs::path path = folder.path() / "lines";
  LineFile file(UniqueFd(::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600)), path);
  file.add("one\n");
  EXPECT_EQ(read_text(path), "");
  for (int i = 0; i < 20'000; ++i) file.add("two\n");
  const std::string until_now = read_text(path);
  EXPECT_GT(until_now.size(), 30'000u);
  EXPECT_EQ(until_now.substr(until_now.size() - 4), "two\n");
  ASSERT_TRUE(file.flush().ok());
  EXPECT_EQ(read_text(path).size(), 80'004u);
}

}  // namespace
}  // namespace zenith::tools
