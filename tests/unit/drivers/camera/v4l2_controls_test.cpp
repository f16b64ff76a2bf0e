#include "drivers/camera/v4l2_controls.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include "tests/unit/drivers/camera/fake_v4l2.h"

namespace zenith {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class V4l2ControlsTest : public ::testing::Test {
 protected:
  std::vector<std::string> apply(const V4l2Settings& settings) {
    const auto opened = open_v4l2_device(io, device.offer.path);
    return apply_v4l2_controls(*opened, settings);
  }
  void number(std::uint32_t id, std::int64_t min, std::int64_t max, std::int64_t value,
              std::uint32_t flags = 0) {
    device.controls.push_back({id, "x", V4L2_CTRL_TYPE_INTEGER, min, max, value, {}, flags});
  }
  void menu(std::uint32_t id, std::vector<int> choices, std::int64_t value) {
    device.controls.push_back(
        {id, "menu", V4L2_CTRL_TYPE_MENU, 0, 3, value, std::move(choices), 0});
  }
  std::int64_t value(std::uint32_t id) {
    for (const FakeControl& control : device.controls) {
      if (control.id == id) return control.value;
    }
    return -1;
  }

  FakeV4l2 io;
  FakeDevice& device = io.add(uvc_webcam_offer());
};

V4l2Settings manual(double exposure_us) {
  V4l2Settings settings;
  settings.exposure = V4l2Exposure::kManual;
  settings.exposure_us = exposure_us;
  return settings;
}

TEST_F(V4l2ControlsTest, NothingAskedNothingTouched) {
  menu(V4L2_CID_EXPOSURE_AUTO, {1, 3}, 3);
  number(V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0, 1, 1);
  EXPECT_TRUE(apply({}).empty());
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO_PRIORITY), 1);
}

TEST_F(V4l2ControlsTest, ManualExposureOfAWebcam) {
  menu(V4L2_CID_EXPOSURE_AUTO, {1, 3}, 3);
  number(V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0, 1, 1);
  number(V4L2_CID_EXPOSURE_ABSOLUTE, 3, 2047, 250);
  EXPECT_TRUE(apply(manual(4200)).empty());
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_MANUAL);
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO_PRIORITY), 0);
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_ABSOLUTE), 42);
}

TEST_F(V4l2ControlsTest, AutomaticExposureTakesTheChoiceThatThereIs) {
  V4l2Settings settings;
  settings.exposure = V4l2Exposure::kAuto;
  menu(V4L2_CID_EXPOSURE_AUTO, {1, 3}, 1);
  EXPECT_TRUE(apply(settings).empty());
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_APERTURE_PRIORITY);
  device.controls.clear();
  menu(V4L2_CID_EXPOSURE_AUTO, {0, 1}, 1);
  EXPECT_TRUE(apply(settings).empty());
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_AUTO);
}

TEST_F(V4l2ControlsTest, ExposureOutOfRangeIsHeldAndSaid) {
  number(V4L2_CID_EXPOSURE_ABSOLUTE, 3, 2047, 250);
  EXPECT_THAT(apply(manual(1e6)), ElementsAre(HasSubstr("2047 instead of 10000")));
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_ABSOLUTE), 2047);
}

// 640 pixels and 160 of blanking at 40 MHz: 20 us a line.
TEST_F(V4l2ControlsTest, ExposureOfASensorIsConvertedToLines) {
  number(V4L2_CID_EXPOSURE, 1, 1000, 100);
  number(V4L2_CID_HBLANK, 160, 160, 160, V4L2_CTRL_FLAG_READ_ONLY);
  number(V4L2_CID_PIXEL_RATE, 0, 0, 40'000'000, V4L2_CTRL_FLAG_READ_ONLY);
  EXPECT_TRUE(apply(manual(5000)).empty());
  EXPECT_EQ(value(V4L2_CID_EXPOSURE), 250);
}

TEST_F(V4l2ControlsTest, ExposureInUnknownUnitsIsNotGuessed) {
  number(V4L2_CID_EXPOSURE, 1, 1000, 100);
  EXPECT_THAT(apply(manual(5000)), ElementsAre(HasSubstr("no control in known units")));
  EXPECT_EQ(value(V4L2_CID_EXPOSURE), 100);
}

TEST_F(V4l2ControlsTest, GainSwitchesTheAutomaticOff) {
  number(V4L2_CID_AUTOGAIN, 0, 1, 1);
  number(V4L2_CID_GAIN, 0, 50, 0, V4L2_CTRL_FLAG_READ_ONLY);
  number(V4L2_CID_ANALOGUE_GAIN, 16, 248, 16);
  V4l2Settings settings;
  settings.gain = 32;
  EXPECT_TRUE(apply(settings).empty());
  EXPECT_EQ(value(V4L2_CID_AUTOGAIN), 0);
  EXPECT_EQ(value(V4L2_CID_GAIN), 0);
  EXPECT_EQ(value(V4L2_CID_ANALOGUE_GAIN), 32);
}

TEST_F(V4l2ControlsTest, MainsFrequency) {
  menu(V4L2_CID_POWER_LINE_FREQUENCY, {0, 1, 2}, 2);
  V4l2Settings settings;
  settings.power_line = V4l2PowerLine::k50Hz;
  EXPECT_TRUE(apply(settings).empty());
  EXPECT_EQ(value(V4L2_CID_POWER_LINE_FREQUENCY), V4L2_CID_POWER_LINE_FREQUENCY_50HZ);
  settings.power_line = V4l2PowerLine::kAuto;
  EXPECT_THAT(apply(settings), ElementsAre(HasSubstr("has not the choice")));
  EXPECT_EQ(value(V4L2_CID_POWER_LINE_FREQUENCY), V4L2_CID_POWER_LINE_FREQUENCY_50HZ);
}

TEST_F(V4l2ControlsTest, MissingControlsAreWarnings) {
  V4l2Settings settings = manual(5000);
  settings.gain = 5;
  settings.power_line = V4l2PowerLine::kOff;
  EXPECT_THAT(apply(settings),
              ElementsAre(HasSubstr("exposure"), HasSubstr("gain"), HasSubstr("mains frequency")));
}

TEST_F(V4l2ControlsTest, RefusalOfTheDriverIsAWarning) {
  number(V4L2_CID_GAIN, 0, 50, 0);
  device.failing[VIDIOC_S_CTRL] = 16;
  V4l2Settings settings;
  settings.gain = 5;
  EXPECT_THAT(apply(settings), ElementsAre(HasSubstr("EBUSY")));
}

}  // namespace
}  // namespace zenith
