#include "platform/daemon/simulated/recording_source.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/odometry/agilex_v2.h"
#include "drivers/odometry/odrive.h"
#include "tests/unit/tools/small_recording.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using tools::small_pixels;
using tools::small_stamp;

constexpr Time kFirstCan = {1'000'000'000};

class RecordingSourceTest : public testing::Test {
 protected:
  RecordingSourceTest() {
    tools::write_small_recording(folder_);
    config_.folder = folder_.string();
  }
  std::unique_ptr<RecordingSource> open() {
    auto source = RecordingSource::open(config_);
    EXPECT_TRUE(source.ok()) << source.error().message;
    return source.ok() ? std::move(*source) : nullptr;
  }
  std::string refusal() {
    const auto source = RecordingSource::open(config_);
    return source.ok() ? "opened" : source.error().message;
  }
  fs::path frame_file(int frame) const {
    return folder_ / "mav0/cam0/data" / (std::to_string(small_stamp(frame).ns) + ".png");
  }

  tools::TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path() / "rec";
  ReplayConfig config_;
};

TEST_F(RecordingSourceTest, PlaysFramesAndCanInTheirOrder) {
  const auto source = open();
  Moment moment;
  std::size_t can = 0;
  Time last = kFirstCan - Duration{1};
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(source->next(moment));
    EXPECT_EQ(moment.stamp, small_stamp(i));
    EXPECT_EQ(moment.frame, MomentFrame::kGood);
    EXPECT_EQ(moment.pixels, small_pixels(i));
    for (const CanFrame& frame : moment.can) {
      EXPECT_EQ(frame.stamp, kFirstCan + Duration{static_cast<std::int64_t>(can++) * 20'000'000});
      EXPECT_GT(frame.stamp, last);
      EXPECT_LE(frame.stamp, moment.stamp);
      last = frame.stamp;
    }
  }
  ASSERT_TRUE(source->next(moment)) << "the wheels after the last frame";
  EXPECT_EQ(moment.frame, MomentFrame::kNone);
  EXPECT_EQ(can + moment.can.size(), 61u);
  EXPECT_FALSE(source->next(moment));
  EXPECT_EQ(source->robot().wheels.track_width_m, 0.437);
  EXPECT_EQ(source->robot().lens.fu_px, 9.5);
  EXPECT_EQ(source->frame_period(), Duration{100'000'000});
}

TEST_F(RecordingSourceTest, AnotherSpeedDrawsAllStampsTogether) {
  config_.speed = 4.0;
  const auto source = open();
  Moment moment;
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(source->next(moment));
    EXPECT_EQ(moment.stamp, kFirstCan + Duration{(small_stamp(i) - kFirstCan).ns / 4});
    if (i == 1) {
      EXPECT_EQ(moment.can.front().stamp, kFirstCan + Duration{5'000'000});
    }
  }
  EXPECT_EQ(source->frame_period(), Duration{25'000'000});
}

TEST_F(RecordingSourceTest, MissingAndDamagedFramesArePassedOver) {
  fs::remove(frame_file(3));
  std::ofstream(frame_file(5)) << "no picture";
  const auto source = open();
  Moment moment;
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(source->next(moment));
    EXPECT_EQ(moment.frame == MomentFrame::kDamaged, i == 3 || i == 5) << i;
    EXPECT_EQ(moment.stamp, small_stamp(i));
    EXPECT_FALSE(moment.can.empty()) << "its wheels are still good";
  }
}

TEST_F(RecordingSourceTest, BeginsAnewWithStampsThatGoOn) {
  config_.loop = true;
  const auto source = open();
  Moment moment;
  Time last;
  int frames = 0;
  for (int i = 0; i < 33; ++i) {
    ASSERT_TRUE(source->next(moment));
    EXPECT_GT(moment.begin(), last);
    last = moment.stamp;
    if (moment.frame == MomentFrame::kNone) continue;
    EXPECT_EQ(moment.pixels, small_pixels(frames % 10));
    ++frames;
  }
  EXPECT_EQ(frames, 30);
}

// Feeds the frames to the decoder after the recording; the sum of both wheels' travel.
double travel_after(const RecordingSource& source, std::vector<CanFrame> standing) {
  WheelDecoder decoder = source.decoder();
  double first = 0.0;
  double last = 0.0;
  for (int i = 0; i < 20; ++i) {
    for (CanFrame& frame : standing) {
      frame.stamp = Time{1'000'000'000} + Duration{i * 10'000'000LL};
      if (const auto sample = decoder.decode(frame)) last = sample->left_m + sample->right_m;
    }
    if (i == 0) first = last;
  }
  return last - first;
}

TEST_F(RecordingSourceTest, StandsWithTheLastPositions) {
  const auto source = open();
  const std::vector<CanFrame> standing = source->standing();
  ASSERT_EQ(standing.size(), 1u);
  const auto odometer = agilex_v2::decode_odometer(standing[0]);
  ASSERT_TRUE(odometer);
  EXPECT_EQ(odometer->left_mm, 600);
  EXPECT_EQ(odometer->right_mm, 660);
  EXPECT_EQ(travel_after(*source, standing), 0.0);
}

// A base that reports velocities, left 1.0 and right 2.0 turns a second to the end.
void write_velocities(const fs::path& folder) {
  RobotFile robot;
  robot.odometry.kind = WheelCodecKind::kOdrive;
  robot.odometry.odrive.quantity = WheelQuantity::kVelocity;
  auto writer = RecordingWriter::create(folder, tools::small_robot(), robot);
  ASSERT_TRUE(writer.ok()) << writer.error().message;
  for (int i = 0; i < 40; ++i) {
    for (const std::uint32_t node : {0u, 1u}) {
      CanFrame frame;
      frame.stamp = kFirstCan + Duration{i * 10'000'000LL};
      frame.id = node << 5 | 0x009;
      frame.length = 8;
      frame.data = {0, 0, 0, 0, 0, 0, node == 0 ? std::uint8_t{0x80} : std::uint8_t{0}, 0};
      frame.data[7] = node == 0 ? 0x3F : 0x40;  // little-endian 1.0f and 2.0f
      writer->add_can(frame);
    }
  }
  const auto pixels = small_pixels(0);
  ASSERT_TRUE(writer->add_frame(small_stamp(0), {pixels.data(), 32, 24, 32}).ok());
  ASSERT_TRUE(writer->finish().ok());
}

TEST_F(RecordingSourceTest, VelocitiesStandAsZeroAndHaveOneSpeed) {
  config_.folder = (temporary_.path() / "velocities").string();
  write_velocities(config_.folder);
  const auto source = open();
  const std::vector<CanFrame> standing = source->standing();
  ASSERT_EQ(standing.size(), 2u);
  EXPECT_EQ(travel_after(*source, standing), 0.0);
  Moment moment;
  ASSERT_TRUE(source->next(moment));
  EXPECT_GT(travel_after(*source, {moment.can.begin(), moment.can.begin() + 2}), 0.1)
      << "the frames of the recording move";
  config_.speed = 2.0;
  EXPECT_THAT(refusal(), HasSubstr("replay.speed is not 1, but the base"));
}

// Without a CAN log the daemon still gets its wheels from a bus: one that tells the same travel.
TEST_F(RecordingSourceTest, TravelWithoutACanLogComesAsFrames) {
  fs::remove(folder_ / "can0.log");
  std::ofstream csv(folder_ / "odometry.csv");
  csv.precision(9);
  for (int i = 0; i <= 60; ++i) {
    csv << 1.0 + 0.02 * i << "," << 5.0 - 0.0100001 * i << "," << 0.0110002 * i << "\n";
  }
  csv.close();
  const auto source = open();
  ASSERT_NE(source, nullptr);
  WheelDecoder decoder = source->decoder();
  auto configured = make_wheel_decoder(source->odometry());
  ASSERT_TRUE(configured.ok()) << configured.error().message;
  Moment moment;
  WheelSample last;
  while (source->next(moment)) {
    for (const CanFrame& frame : moment.can) {
      const auto sample = decoder.decode(frame);
      const auto same = configured->decode(frame);
      ASSERT_TRUE(sample && same);
      EXPECT_EQ(sample->left_m, same->left_m);
      last = *sample;
    }
  }
  EXPECT_NEAR(last.left_m, -0.600006, 1e-6);
  EXPECT_NEAR(last.right_m, 0.660012, 1e-6);
  EXPECT_EQ(travel_after(*source, source->standing()), 0.0);
}

TEST_F(RecordingSourceTest, SaysWhatIsMissing) {
  fs::remove(folder_ / "can0.log");
  EXPECT_THAT(refusal(), HasSubstr("can0.log"));
  config_.folder = (temporary_.path() / "nothing").string();
  EXPECT_THAT(refusal(), HasSubstr("nothing: no such folder"));
}

}  // namespace
}  // namespace zenith
