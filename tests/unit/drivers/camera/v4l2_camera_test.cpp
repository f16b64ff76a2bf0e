#include "drivers/camera/v4l2_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <cerrno>

#include "tests/unit/drivers/camera/fake_v4l2.h"

namespace zenith {
namespace {

using ::testing::HasSubstr;

constexpr Duration kPeriod = {40'000'000};
constexpr Duration kLong = {1'000'000'000};

Duration periods(double count) {
  return Duration::from_seconds(count * kPeriod.seconds());
}

class V4l2CameraTest : public ::testing::Test {
 protected:
  V4l2CameraTest() {
    settings.device = device.offer.path;
    settings.rate_hz = 25;
  }

  void open() {
    camera = std::make_unique<V4l2Camera>(settings, io);
    const Status status = camera->open();
    ASSERT_TRUE(status.ok()) << status.error().message;
  }
  std::string open_error() {
    camera = std::make_unique<V4l2Camera>(settings, io);
    const Status status = camera->open();
    return status.ok() ? "opened" : status.error().message;
  }
  CameraWait wait(Duration timeout = kLong) { return camera->wait(timeout, frame); }
  const CameraCounters& counters() const { return camera->counters(); }
  std::uint8_t grey(std::uint64_t number) const {
    return static_cast<std::uint8_t>(FakeV4l2::kFirstValue + number);
  }
  // All pixels of `frame` have the value of the frame with this number.
  void expect_picture(std::uint64_t number) const {
    ASSERT_EQ(frame.luma.width, settings.width);
    ASSERT_EQ(frame.luma.height, settings.height);
    for (const int v : {0, 1, settings.height - 1}) {
      for (const int u : {0, 1, settings.width - 1}) EXPECT_EQ(frame.luma.at(u, v), grey(number));
    }
  }

  FakeV4l2 io;
  FakeDevice& device = io.add(vivid_offer());
  V4l2Settings settings;
  std::unique_ptr<V4l2Camera> camera;
  CameraFrame frame;
};

TEST_F(V4l2CameraTest, PassesOverTheFirstFrameOfEachStream) {
  open();
  for (int stream = 0; stream < 2; ++stream) {
    ASSERT_EQ(wait(), CameraWait::kFrame);
    EXPECT_NE(frame.luma.at(0, 0), FakeV4l2::kStaleValue);
    expect_picture(0);
    EXPECT_EQ(counters().lost_in_driver, 0u);
    camera->close();
    ASSERT_TRUE(camera->open());
  }
}

TEST_F(V4l2CameraTest, DeliversEachFrameWithItsStampAndNumber) {
  open();
  const Time start = io.now();
  for (std::uint64_t i = 0; i < 10; ++i) {
    ASSERT_EQ(wait(), CameraWait::kFrame);
    EXPECT_EQ(frame.sequence, i);
    EXPECT_EQ(frame.stamp, start + Duration{static_cast<std::int64_t>(i + 1) * kPeriod.ns});
    expect_picture(i);
  }
  EXPECT_EQ(counters().frames, 10u);
  EXPECT_EQ(counters().skipped + counters().lost_in_driver + counters().damaged, 0u);
  EXPECT_EQ(counters().stamps_replaced, 0u);
  EXPECT_EQ(camera->description(), "V4L2 /dev/video50 (vivid), GREY 640x480, 25/s");
  EXPECT_EQ(camera->period(), Duration{40'000'000});
  EXPECT_TRUE(camera->warnings().empty());
}

TEST_F(V4l2CameraTest, EveryLayoutGivesTheSamePicture) {
  for (const char* format : {"GREY", "NV12", "YUYV", "UYVY"}) {
    for (const bool copy : {false, true}) {
      settings.format = format;
      settings.copy = copy;
      device.padding = 64;
      open();
      ASSERT_EQ(wait(), CameraWait::kFrame);
      SCOPED_TRACE(format);
      expect_picture(0);
      const bool in_place = frame.luma.stride == 640 + 64;
      EXPECT_EQ(in_place, !copy && (settings.format == "GREY" || settings.format == "NV12"));
      camera.reset();
    }
  }
}

TEST_F(V4l2CameraTest, MultiPlanarDevices) {
  FakeDevice& isp = io.add(isp_offer());
  settings.device = isp.offer.path;
  settings.rate_hz = 30;
  open();
  ASSERT_EQ(wait(), CameraWait::kFrame);
  expect_picture(0);
  EXPECT_THAT(camera->description(), HasSubstr("NM12 640x480, 30/s"));
}

TEST_F(V4l2CameraTest, NoFrameIsATimeoutOfTheAskedLength) {
  open();
  const Time start = io.now();
  EXPECT_EQ(wait(periods(0.5)), CameraWait::kTimeout);
  EXPECT_EQ(io.now() - start, periods(0.5));
  EXPECT_EQ(wait(Duration{0}), CameraWait::kTimeout);
  EXPECT_EQ(wait(Duration{-5}), CameraWait::kTimeout);
  EXPECT_EQ(io.now() - start, periods(0.5));
  EXPECT_EQ(wait(), CameraWait::kFrame);
}

TEST_F(V4l2CameraTest, SlowReaderGetsTheNewestAndTheRestIsCounted) {
  open();
  ASSERT_EQ(wait(), CameraWait::kFrame);
  io.advance(periods(2.5));
  ASSERT_EQ(wait(), CameraWait::kFrame);
  EXPECT_EQ(frame.sequence, 2u);
  expect_picture(2);
  EXPECT_EQ(counters().skipped, 1u);
  EXPECT_EQ(counters().lost_in_driver, 0u);
}

// The buffers fill up within three periods; what lies in them after twenty is old.
TEST_F(V4l2CameraTest, AfterALongPauseAFreshFrameIsWaitedFor) {
  open();
  ASSERT_EQ(wait(), CameraWait::kFrame);
  io.advance(periods(20.5));
  ASSERT_EQ(wait(), CameraWait::kFrame);
  EXPECT_EQ(frame.stamp, io.now());
  EXPECT_EQ(frame.sequence, 21u);
  expect_picture(21);
  EXPECT_EQ(counters().skipped + counters().lost_in_driver, 20u);
}

TEST_F(V4l2CameraTest, AnOldFrameIsBetterThanNone) {
  open();
  ASSERT_EQ(wait(), CameraWait::kFrame);
  io.advance(periods(20.5));
  ASSERT_EQ(wait(Duration{0}), CameraWait::kFrame);
  expect_picture(3);
}

// A pipeline that delivers late must not be taken for a reader that is late.
TEST_F(V4l2CameraTest, LatencyOfTheCameraIsNotStaleness) {
  device.latency = periods(6);
  settings.buffers = 2;
  open();
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(wait(periods(1.5)), CameraWait::kFrame);
    EXPECT_EQ(frame.sequence, static_cast<std::uint64_t>(i));
  }
}

TEST_F(V4l2CameraTest, SequenceStartsAnywhereWrapsAndShowsLosses) {
  device.first_sequence = 0xFFFFFFFEu;
  device.spoil = [](FakeFrame& f) { f.dropped = f.number == 3 || f.number == 4; };
  open();
  for (const std::uint64_t expected : {0, 1, 2, 5, 6}) {
    ASSERT_EQ(wait(), CameraWait::kFrame);
    EXPECT_EQ(frame.sequence, expected);
  }
  EXPECT_EQ(counters().lost_in_driver, 2u);
}

TEST_F(V4l2CameraTest, DamagedAndShortFramesAreCountedAndNotDelivered) {
  device.spoil = [](FakeFrame& f) {
    if (f.number == 1) f.flags |= V4L2_BUF_FLAG_ERROR;
    if (f.number == 2) f.bytes_used -= 1;
    if (f.number == 3) f.bytes_used = 0;
  };
  open();
  ASSERT_EQ(wait(), CameraWait::kFrame);
  ASSERT_EQ(wait(), CameraWait::kFrame);
  EXPECT_EQ(frame.sequence, 4u);
  expect_picture(4);
  EXPECT_EQ(counters().damaged, 3u);
  for (int i = 0; i < 20; ++i) ASSERT_EQ(wait(), CameraWait::kFrame);  // no buffer got lost
}

TEST_F(V4l2CameraTest, DamagedNewestFallsBackToTheGoodOneBefore) {
  device.spoil = [](FakeFrame& f) {
    if (f.number == 2) f.flags |= V4L2_BUF_FLAG_ERROR;
  };
  open();
  ASSERT_EQ(wait(), CameraWait::kFrame);
  io.advance(periods(2.5));
  ASSERT_EQ(wait(), CameraWait::kFrame);
  EXPECT_EQ(frame.sequence, 1u);
  expect_picture(1);
}

TEST_F(V4l2CameraTest, UnmarkedStampsOfTheRightClockAreUsed) {
  device.spoil = [](FakeFrame& f) { f.flags = 0; };
  device.latency = Duration{5'000'000};
  open();
  ASSERT_EQ(wait(), CameraWait::kFrame);
  EXPECT_EQ(frame.stamp, io.now() - device.latency);
  EXPECT_EQ(counters().stamps_replaced, 0u);
}

TEST_F(V4l2CameraTest, StampsOfAnotherClockAreReplacedAndCounted) {
  device.spoil = [](FakeFrame& f) {
    f.flags = V4L2_BUF_FLAG_TIMESTAMP_COPY;
    f.stamp = Time{1'700'000'000'000'000'000} + Duration{f.stamp.ns};
  };
  open();
  Time last;
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(wait(), CameraWait::kFrame);
    EXPECT_EQ(frame.stamp, io.now());
    EXPECT_GT(frame.stamp, last);
    last = frame.stamp;
  }
  EXPECT_EQ(counters().stamps_replaced, 5u);
}

TEST_F(V4l2CameraTest, UnplugIsLostUntilReopened) {
  open();
  ASSERT_EQ(wait(), CameraWait::kFrame);
  device.present = false;
  EXPECT_EQ(wait(), CameraWait::kLost);
  EXPECT_EQ(wait(), CameraWait::kLost);
  EXPECT_EQ(counters().lost, 1u);
  EXPECT_STREQ(camera->lost_reason(), "the camera was unplugged (ENODEV)");
  EXPECT_THAT(camera->open().error().message, HasSubstr("ENOENT"));
  EXPECT_EQ(wait(), CameraWait::kLost);
  device.present = true;
  ASSERT_TRUE(camera->open().ok());
  EXPECT_STREQ(camera->lost_reason(), "");
  ASSERT_EQ(wait(), CameraWait::kFrame);
  EXPECT_EQ(frame.sequence, 0u);
  EXPECT_EQ(counters().opened, 2u);
}

TEST_F(V4l2CameraTest, ReplugUnderAnotherNumberIsFoundByName) {
  settings.device = "name:vivid";
  open();
  ASSERT_EQ(wait(), CameraWait::kFrame);
  device.present = false;
  ASSERT_EQ(wait(), CameraWait::kLost);
  V4l2Offer moved = vivid_offer();
  moved.path = "/dev/video51";
  io.add(moved);
  ASSERT_TRUE(camera->open().ok());
  EXPECT_THAT(camera->description(), HasSubstr("/dev/video51"));
  EXPECT_EQ(wait(), CameraWait::kFrame);
}

TEST_F(V4l2CameraTest, StreamErrorsAreLostAndReopeningHeals) {
  for (const int error : {EIO, EPIPE, EINVAL}) {
    open();
    ASSERT_EQ(wait(), CameraWait::kFrame);
    device.stream_error = error;
    EXPECT_EQ(wait(), CameraWait::kLost);
    ASSERT_TRUE(camera->open().ok());
    EXPECT_EQ(wait(), CameraWait::kFrame);
    camera.reset();
  }
}

TEST_F(V4l2CameraTest, ErrorWhileWaitingIsLost) {
  open();
  device.failing[VIDIOC_DQBUF] = EAGAIN;
  device.stream_error = EIO;  // only poll() sees it
  EXPECT_EQ(wait(), CameraWait::kLost);
  EXPECT_THAT(camera->lost_reason(), HasSubstr("POLLERR"));
}

TEST_F(V4l2CameraTest, BufferThatCannotGoBackIsLost) {
  open();
  ASSERT_EQ(wait(), CameraWait::kFrame);
  device.failing[VIDIOC_QBUF] = ENODEV;
  EXPECT_EQ(wait(), CameraWait::kLost);
}

TEST_F(V4l2CameraTest, SilenceIsLostAfterTheSetTime) {
  settings.stall_s = 2.0;
  open();
  ASSERT_EQ(wait(), CameraWait::kFrame);
  const Time last = io.now();
  device.frozen = true;
  EXPECT_EQ(wait(Duration{1'900'000'000}), CameraWait::kTimeout);
  EXPECT_EQ(wait(Duration{5'000'000'000}), CameraWait::kLost);
  EXPECT_EQ(io.now() - last, Duration{2'000'000'000});
  EXPECT_EQ(counters().stalled, 1u);
  EXPECT_EQ(counters().lost, 1u);
  device.frozen = false;
  ASSERT_TRUE(camera->open().ok());
  EXPECT_EQ(wait(), CameraWait::kFrame);
}

TEST_F(V4l2CameraTest, FirstFrameMayTakeLonger) {
  settings.stall_s = 1.0;
  settings.first_frame_s = 5.0;
  device.frozen = true;
  open();
  const Time start = io.now();
  EXPECT_EQ(wait(Duration{4'900'000'000}), CameraWait::kTimeout);
  EXPECT_EQ(wait(Duration{4'900'000'000}), CameraWait::kLost);
  EXPECT_EQ(io.now() - start, Duration{5'000'000'000});
}

TEST_F(V4l2CameraTest, NothingButDamageIsSilenceToo) {
  device.spoil = [](FakeFrame& f) {
    if (f.number > 0) f.flags |= V4L2_BUF_FLAG_ERROR;
  };
  open();
  ASSERT_EQ(wait(), CameraWait::kFrame);
  EXPECT_EQ(wait(Duration{60'000'000'000}), CameraWait::kLost);
  EXPECT_EQ(counters().stalled, 1u);
}

TEST_F(V4l2CameraTest, APauseOfTheReaderIsNoStall) {
  open();
  ASSERT_EQ(wait(), CameraWait::kFrame);
  io.advance(Duration{60'000'000'000});
  EXPECT_EQ(wait(), CameraWait::kFrame);
}

TEST_F(V4l2CameraTest, CloseGivesEverythingBack) {
  open();
  ASSERT_EQ(wait(), CameraWait::kFrame);
  camera->close();
  EXPECT_EQ(device.mapped, 0);
  EXPECT_EQ(device.open_files, 0);
  EXPECT_FALSE(device.streaming);
  EXPECT_EQ(wait(), CameraWait::kLost);
  EXPECT_EQ(counters().lost, 0u);
  camera->close();
}

TEST_F(V4l2CameraTest, FailureOfEachCallIsAnErrorAndGivesEverythingBack) {
  for (const unsigned long request : {VIDIOC_QUERYCAP, VIDIOC_S_FMT, VIDIOC_REQBUFS,
                                      VIDIOC_QUERYBUF, VIDIOC_QBUF, VIDIOC_STREAMON}) {
    device.failing = {{request, EBUSY}};
    EXPECT_THAT(open_error(), HasSubstr("EBUSY"));
    EXPECT_EQ(device.mapped, 0);
    EXPECT_EQ(device.open_files, 0);
    EXPECT_EQ(camera->wait(kLong, frame), CameraWait::kLost);
  }
  device.failing.clear();
  EXPECT_EQ(open_error(), "opened");
}

TEST_F(V4l2CameraTest, DriverThatChangesTheSizeIsRefused) {
  device.set_width = 648;
  EXPECT_THAT(open_error(), HasSubstr("was asked for GREY 640x480 and set GREY 648x480"));
}

TEST_F(V4l2CameraTest, InterlacedIsRefused) {
  device.field = V4L2_FIELD_INTERLACED;
  EXPECT_THAT(open_error(), HasSubstr("interlaced"));
}

TEST_F(V4l2CameraTest, FewerBuffersAreTakenDownToTwo) {
  device.max_buffers = 2;
  open();
  for (int i = 0; i < 5; ++i) ASSERT_EQ(wait(), CameraWait::kFrame);
  EXPECT_EQ(counters().lost_in_driver, 0u);
  device.max_buffers = 1;
  EXPECT_THAT(open_error(), HasSubstr("gave 1 of 4 buffers"));
}

TEST_F(V4l2CameraTest, AsksForCachedBuffersWhereTheKernelCan) {
  open();
  EXPECT_EQ(device.granted_flags, static_cast<std::uint32_t>(V4L2_MEMORY_FLAG_NON_COHERENT));
}

TEST_F(V4l2CameraTest, IdleLoopbackSaysThatItsWriterIsMissing) {
  FakeDevice& loopback = io.add(idle_loopback_offer());
  settings.device = loopback.offer.path;
  EXPECT_THAT(open_error(), HasSubstr("start the writer"));
}

TEST_F(V4l2CameraTest, RateThatCannotBeSetIsAWarning) {
  device.settable_rate = false;
  device.interval = {1, 10};
  open();
  ASSERT_EQ(camera->warnings().size(), 1u);
  EXPECT_THAT(camera->warnings()[0], HasSubstr("10/s instead of 25/s"));
  device.failing[VIDIOC_G_PARM] = ENOTTY;
  open();
  ASSERT_EQ(camera->warnings().size(), 1u);
  EXPECT_THAT(camera->warnings()[0], HasSubstr("does not tell its rate"));
}

TEST_F(V4l2CameraTest, AllWrongSettingsAreNamedAtOnce) {
  settings.width = 0;
  settings.rate_hz = -1;
  settings.buffers = 1;
  settings.stall_s = 0;
  settings.format = "GREYSCALE";
  const std::string error = open_error();
  for (const char* part : {"width", "rate_hz", "buffers", "stall_s", "format"}) {
    EXPECT_THAT(error, HasSubstr(part));
  }
}

}  // namespace
}  // namespace zenith
