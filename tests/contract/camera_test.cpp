// What every camera promises: drivers/camera/camera.h.

#include <cstring>
#include <memory>

#include <gtest/gtest.h>

#include "tests/contract/allocations.h"
#include "tests/contract/camera_rigs.h"
#include "tests/support/patience.h"

namespace zenith {
namespace {

constexpr Duration kShort = {30'000'000};
// "At once": it did not wait, however slow the computer.
constexpr Duration kSoon = {kPatience.ns / 2};

class CameraContract : public ::testing::TestWithParam<std::size_t> {
 protected:
  void SetUp() override {
    rig_ = camera_rigs()[GetParam()].make();
    if (!rig_->missing().empty()) GTEST_SKIP() << rig_->missing();
    camera_ = &rig_->camera();
  }

  void open() {
    const Status opened = camera_->open();
    ASSERT_TRUE(opened.ok()) << opened.error().message;
    at_open_ = numbers();
  }
  // The next frame; its stamp is newer than the last one's.
  void next() {
    const Time last = frame_.stamp;
    ASSERT_EQ(camera_->wait(kPatience, frame_), CameraWait::kFrame) << camera_->lost_reason();
    ASSERT_GT(frame_.stamp, last);
    ASSERT_EQ(frame_.luma.width, rig_->width_px());
    ASSERT_EQ(frame_.luma.height, rig_->height_px());
  }
  // All frames that the camera knows of.
  std::uint64_t numbers() const {
    const CameraCounters& c = camera_->counters();
    return c.frames + c.skipped + c.lost_in_driver + c.damaged;
  }
  // Frames that came while the last one was looked at. Cameras that cannot be held still may need
  // several tries, and those that are slower than their rate longer ones.
  void next_after_skipped(int count) {
    const Time end = rig_->now() + kPatience;
    const std::uint64_t skipped = passed_over();
    for (; passed_over() == skipped && rig_->now() < end; count *= 2) {
      rig_->let_frames_come(count);
      next();
    }
    ASSERT_GT(passed_over(), skipped);
  }
  std::uint64_t passed_over() const {
    return camera_->counters().skipped + camera_->counters().lost_in_driver;
  }
  // Until nothing is left.
  void hold_still() {
    rig_->hold_still(true);
    const Time end = rig_->now() + kPatience;
    while (camera_->wait({}, frame_) == CameraWait::kFrame && rig_->now() < end) {
    }
  }
  std::vector<std::uint8_t> pixels() const {
    std::vector<std::uint8_t> copy;
    for (int v = 0; v < frame_.luma.height; ++v) {
      const std::uint8_t* row = frame_.luma.row(v);
      copy.insert(copy.end(), row, row + frame_.luma.width);
    }
    return copy;
  }
  void wait_until_lost() {
    const Time end = rig_->now() + kPatience;
    while (rig_->now() < end && camera_->wait(kShort, frame_) != CameraWait::kLost) {
    }
    ASSERT_EQ(camera_->wait(kShort, frame_), CameraWait::kLost);
  }

  std::unique_ptr<CameraRig> rig_;
  Camera* camera_ = nullptr;
  CameraFrame frame_;
  std::uint64_t at_open_ = 0;
};

TEST_P(CameraContract, ClosedItIsLostAtOnce) {
  for (int i = 0; i < 2; ++i) {
    const Time start = rig_->now();
    EXPECT_EQ(camera_->wait(kPatience, frame_), CameraWait::kLost);
    EXPECT_LT(rig_->now() - start, kSoon);
    EXPECT_STRNE(camera_->lost_reason(), "");
    camera_->close();
    camera_->close();
  }
  EXPECT_EQ(camera_->counters().opened, 0u);
  EXPECT_EQ(camera_->counters().lost, 0u) << "it was never there";
}

TEST_P(CameraContract, FramesComeWithRisingStampsOfTheirCapture) {
  const Time before = rig_->now();
  open();
  EXPECT_FALSE(camera_->description().empty());
  for (const std::string& warning : camera_->warnings()) EXPECT_FALSE(warning.empty());
  EXPECT_STREQ(camera_->lost_reason(), "");
  EXPECT_GE(camera_->period(), Duration{0});
  EXPECT_LE(camera_->period(), Duration{10'000'000'000});
  for (int i = 0; i < 8; ++i) {
    ASSERT_NO_FATAL_FAILURE(next());
    EXPECT_GT(frame_.stamp, before);
    EXPECT_LE(frame_.stamp, rig_->now());
  }
  EXPECT_EQ(camera_->counters().frames, 8u);
  EXPECT_EQ(camera_->counters().opened, 1u);
  EXPECT_EQ(camera_->counters().stamps_replaced, 0u);
}

TEST_P(CameraContract, NumbersCountAllFramesSinceOpen) {
  for (int opened = 0; opened < 2; ++opened) {
    open();
    for (int i = 0; i < 3; ++i) {
      ASSERT_NO_FATAL_FAILURE(next());
      EXPECT_EQ(frame_.sequence + 1, numbers() - at_open_);
    }
    // More than any queue of buffers holds: the gap stands before the frame after those.
    ASSERT_NO_FATAL_FAILURE(next_after_skipped(12));
    ASSERT_NO_FATAL_FAILURE(next());
    EXPECT_EQ(frame_.sequence + 1, numbers() - at_open_);
    EXPECT_GE(frame_.sequence, 5u);
    camera_->close();
  }
}

TEST_P(CameraContract, TheNewestFrameWins) {
  open();
  ASSERT_NO_FATAL_FAILURE(next());
  if (!rig_->is_exact()) return next_after_skipped(3);
  hold_still();
  const std::uint64_t last = frame_.sequence;
  const std::uint64_t skipped = camera_->counters().skipped;
  rig_->let_frames_come(3);
  ASSERT_NO_FATAL_FAILURE(next());
  EXPECT_EQ(frame_.sequence, last + 3);
  EXPECT_EQ(camera_->counters().skipped, skipped + 2);
  EXPECT_EQ(camera_->wait({}, frame_), CameraWait::kTimeout) << "an older one came after it";
}

TEST_P(CameraContract, WaitsAsLongAsItsTimeoutAndNotAtAllForZero) {
  open();
  ASSERT_NO_FATAL_FAILURE(next());
  hold_still();
  const Time start = rig_->now();
  for (const Duration timeout : {Duration{0}, Duration{-1}, Duration{-kPatience.ns}}) {
    const CameraWait result = camera_->wait(timeout, frame_);
    EXPECT_NE(result, CameraWait::kLost);
    if (rig_->is_exact()) {
      EXPECT_EQ(result, CameraWait::kTimeout);
    }
  }
  EXPECT_LT(rig_->now() - start, kSoon);
  if (!rig_->is_exact()) return;  // the next frame may come at any moment
  const Time now = rig_->now();
  EXPECT_EQ(camera_->wait(kShort, frame_), CameraWait::kTimeout);
  EXPECT_GE(rig_->now() - now, kShort);
  rig_->hold_still(false);
  next();
}

TEST_P(CameraContract, StampsRiseOverCloseAndOpen) {
  for (int i = 0; i < 3; ++i) {
    open();
    ASSERT_NO_FATAL_FAILURE(next());
    ASSERT_NO_FATAL_FAILURE(next());
    rig_->let_frames_come(2);
    camera_->close();
    camera_->close();
    EXPECT_EQ(camera_->wait({}, frame_), CameraWait::kLost);
    EXPECT_STRNE(camera_->lost_reason(), "");
  }
  EXPECT_EQ(camera_->counters().opened, 3u);
  EXPECT_EQ(camera_->counters().lost, 0u) << "it was closed, not lost";
}

TEST_P(CameraContract, OpensAgainWhileOpen) {
  open();
  ASSERT_NO_FATAL_FAILURE(next());
  open();
  ASSERT_NO_FATAL_FAILURE(next());
  EXPECT_EQ(frame_.sequence + 1, numbers() - at_open_) << "counted from the second open()";
  EXPECT_EQ(camera_->counters().opened, 2u);
}

TEST_P(CameraContract, APictureStaysUntilTheNextWait) {
  open();
  bool changed = false;
  std::vector<std::uint8_t> last;
  for (int i = 0; i < 4; ++i) {
    ASSERT_NO_FATAL_FAILURE(next());
    const std::vector<std::uint8_t> seen = pixels();
    changed = changed || (i > 0 && seen != last);
    last = seen;
    rig_->change_picture();
    rig_->let_frames_come(12);
    EXPECT_EQ(pixels(), seen);
  }
  EXPECT_TRUE(changed) << "the pictures are all alike: this test proves nothing";
}

TEST_P(CameraContract, WaitingTakesNoMemory) {
  open();
  ASSERT_NO_FATAL_FAILURE(next());
  const std::uint64_t before = thread_allocation_count();
  int frames = 0;
  const Time end = rig_->now() + kPatience;
  while (frames < 10 && rig_->now() < end) {
    if (camera_->wait(kShort, frame_) == CameraWait::kFrame) ++frames;
    camera_->wait({}, frame_);
  }
  const std::uint64_t after = thread_allocation_count();
  EXPECT_EQ(after, before);
  EXPECT_EQ(frames, 10);
}

TEST_P(CameraContract, PulledOutItIsLostUntilItIsOpenedAgain) {
  if (!rig_->can_fail()) GTEST_SKIP() << "this camera cannot be pulled out here";
  open();
  ASSERT_NO_FATAL_FAILURE(next());
  rig_->set_plugged(false);
  ASSERT_NO_FATAL_FAILURE(wait_until_lost());
  EXPECT_STRNE(camera_->lost_reason(), "");
  EXPECT_EQ(camera_->counters().lost, 1u);
  const Time start = rig_->now();
  EXPECT_EQ(camera_->wait(kPatience, frame_), CameraWait::kLost);
  EXPECT_LT(rig_->now() - start, kSoon);

  const Status refused = camera_->open();
  ASSERT_FALSE(refused.ok());
  EXPECT_FALSE(refused.error().message.empty());
  EXPECT_EQ(camera_->wait({}, frame_), CameraWait::kLost);

  rig_->set_plugged(true);
  EXPECT_EQ(camera_->wait({}, frame_), CameraWait::kLost) << "not before open()";
  open();
  ASSERT_NO_FATAL_FAILURE(next());
  EXPECT_STREQ(camera_->lost_reason(), "");
  EXPECT_EQ(camera_->counters().lost, 1u);
  EXPECT_EQ(camera_->counters().opened, 2u);
}

std::string name_of(const ::testing::TestParamInfo<std::size_t>& info) {
  return camera_rigs()[info.param].name;
}

INSTANTIATE_TEST_SUITE_P(Cameras, CameraContract,
                         ::testing::Range(std::size_t{0}, camera_rigs().size()), name_of);

}  // namespace
}  // namespace zenith
