#include "drivers/camera/v4l2_device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/camera/v4l2_enumerate.h"
#include "drivers/camera/v4l2_probe.h"
#include "tests/unit/drivers/camera/fake_v4l2.h"

namespace zenith {
namespace {

using ::testing::HasSubstr;

// A webcam with its second node, which does not capture, and another camera on a second port.
class V4l2DeviceTest : public ::testing::Test {
 protected:
  V4l2DeviceTest() {
    V4l2Offer metadata = uvc_webcam_offer();
    metadata.path = "/dev/video2";
    metadata.captures = false;
    metadata.formats.clear();
    io.add(metadata);
    V4l2Offer webcam = uvc_webcam_offer();
    webcam.path = "/dev/video3";
    io.add(webcam);
    io.add(vivid_offer());
  }

  std::string error_of(const std::string& name) {
    const auto found = find_v4l2_device(io, name);
    return found.ok() ? "found " + *found : found.error().message;
  }

  FakeV4l2 io;
};

TEST_F(V4l2DeviceTest, FoundByNameOrBusWhateverTheNumber) {
  EXPECT_EQ(error_of("name:USB Camera"), "found /dev/video3");
  EXPECT_EQ(error_of("bus:vivid-000"), "found /dev/video50");
  EXPECT_EQ(error_of("/dev/v4l/by-id/x"), "found /dev/v4l/by-id/x");
}

TEST_F(V4l2DeviceTest, NameThatFitsNothingListsWhatThereIs) {
  const std::string error = error_of("name:Fisheye");
  EXPECT_THAT(error, HasSubstr("no camera fits \"name:Fisheye\""));
  EXPECT_THAT(error, HasSubstr("/dev/video3 'USB 2.0 Camera: USB Camera' (usb-0000:01:00.0-1.2)"));
  EXPECT_THAT(error, HasSubstr("which does not capture now"));
}

TEST_F(V4l2DeviceTest, NameThatFitsTwoCamerasIsRefused) {
  V4l2Offer second = uvc_webcam_offer();
  second.path = "/dev/video9";
  second.bus = "usb-0000:01:00.0-1.3";
  io.add(second);
  EXPECT_THAT(error_of("name:USB Camera"), HasSubstr("several cameras fit"));
  EXPECT_EQ(error_of("bus:1.3"), "found /dev/video9");
}

TEST_F(V4l2DeviceTest, OtherNamesAreRefused) {
  EXPECT_THAT(error_of("video0"), HasSubstr("write a path"));
  EXPECT_THAT(error_of(""), HasSubstr("write a path"));
  EXPECT_THAT(error_of("name:"), HasSubstr("no camera fits"));
}

TEST_F(V4l2DeviceTest, MissingFileSaysWhatToDo) {
  const auto device = open_v4l2_device(io, "/dev/video99");
  ASSERT_FALSE(device.ok());
  EXPECT_THAT(device.error().message, HasSubstr("ENOENT"));
  EXPECT_THAT(device.error().message, HasSubstr("plugged in"));
}

void expect_same_size(const V4l2SizeOffer& a, const V4l2SizeOffer& b) {
  EXPECT_EQ(a.min_width, b.min_width);
  EXPECT_EQ(a.max_width, b.max_width);
  EXPECT_EQ(a.step_width, b.step_width);
  EXPECT_EQ(a.min_height, b.min_height);
  EXPECT_EQ(a.max_height, b.max_height);
  EXPECT_EQ(a.step_height, b.step_height);
}

TEST(V4l2Enumerate, BringsBackWhatTheDeviceOffers) {
  for (const V4l2Offer& offer :
       {uvc_webcam_offer(), mono_sensor_offer(), vivid_offer(), isp_offer()}) {
    FakeV4l2 io;
    io.add(offer);
    const auto device = open_v4l2_device(io, offer.path);
    ASSERT_TRUE(device.ok());
    const auto read = enumerate_v4l2(*device, offer.path, 640, 480);
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(read->card, offer.card);
    EXPECT_EQ(read->bus, offer.bus);
    EXPECT_EQ(read->driver, offer.driver);
    EXPECT_EQ(read->multiplanar, offer.multiplanar);
    EXPECT_EQ(offer_text(*read), offer_text(offer));
    ASSERT_EQ(read->formats.size(), offer.formats.size());
    for (std::size_t i = 0; i < offer.formats.size(); ++i) {
      ASSERT_EQ(read->formats[i].sizes.size(), offer.formats[i].sizes.size());
      EXPECT_EQ(read->formats[i].description, offer.formats[i].description);
      for (std::size_t k = 0; k < offer.formats[i].sizes.size(); ++k) {
        expect_same_size(read->formats[i].sizes[k], offer.formats[i].sizes[k]);
      }
    }
  }
}

TEST(V4l2Enumerate, TextsThatFillTheirFieldsAreNotReadBeyond) {
  FakeV4l2 io;
  V4l2Offer offer = vivid_offer();
  offer.card = std::string(40, 'c');
  io.add(offer);
  const auto device = open_v4l2_device(io, offer.path);
  const auto read = read_identity(*device, offer.path);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->card, std::string(32, 'c'));
}

TEST(V4l2Probe, ListsAllAndSaysWhichCanBeRead) {
  FakeV4l2 io;
  io.add(idle_loopback_offer());
  FakeDevice& webcam = io.add(uvc_webcam_offer());
  webcam.controls = {{V4L2_CID_GAIN, "Gain", V4L2_CTRL_TYPE_INTEGER, 0, 100, 7, {}, 0},
                     {V4L2_CID_POWER_LINE_FREQUENCY,
                      "Power Line Frequency",
                      V4L2_CTRL_TYPE_MENU,
                      0,
                      2,
                      1,
                      {0, 1, 2},
                      0}};
  io.add(vivid_offer()).failing[VIDIOC_QUERYCAP] = 25;
  const auto devices = probe_v4l2(640, 480, io);
  ASSERT_EQ(devices.size(), 3u);
  EXPECT_FALSE(devices[0].readable);
  EXPECT_TRUE(devices[0].offer.has_output);
  EXPECT_TRUE(devices[1].readable);
  ASSERT_EQ(devices[1].controls.size(), 2u);
  EXPECT_EQ(devices[1].controls[0].name, "Gain");
  EXPECT_EQ(devices[1].controls[0].value, 7);
  EXPECT_EQ(devices[1].controls[1].choices.size(), 3u);
  EXPECT_EQ(devices[1].offer.formats.size(), 2u);
  EXPECT_THAT(devices[2].problem, HasSubstr("no V4L2 device"));
}

}  // namespace
}  // namespace zenith
