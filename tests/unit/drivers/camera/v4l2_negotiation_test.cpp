#include "drivers/camera/v4l2_negotiation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include "tests/unit/drivers/camera/fake_v4l2.h"

namespace zenith {
namespace {

using ::testing::HasSubstr;

V4l2Settings ask(int width, int height, double rate_hz, const std::string& format = "auto") {
  V4l2Settings settings;
  settings.width = width;
  settings.height = height;
  settings.rate_hz = rate_hz;
  settings.format = format;
  return settings;
}

TEST(V4l2Negotiation, WebcamGivesYuyvAtTheAskedRate) {
  const auto mode = negotiate_v4l2(uvc_webcam_offer(), ask(640, 480, 30));
  ASSERT_TRUE(mode.ok()) << mode.error().message;
  EXPECT_EQ(mode->fourcc, V4L2_PIX_FMT_YUYV);
  EXPECT_EQ(mode->interval.rate_hz(), 30.0);
  EXPECT_TRUE(mode->warnings.empty());
}

TEST(V4l2Negotiation, TakesTheSlowestRateThatSuffices) {
  EXPECT_EQ(negotiate_v4l2(uvc_webcam_offer(), ask(640, 480, 12))->interval.rate_hz(), 15.0);
  EXPECT_EQ(negotiate_v4l2(uvc_webcam_offer(), ask(640, 480, 10))->interval.rate_hz(), 10.0);
}

TEST(V4l2Negotiation, SlowerThanAskedIsAWarning) {
  const auto mode = negotiate_v4l2(uvc_webcam_offer(), ask(1280, 720, 30));
  ASSERT_TRUE(mode.ok());
  EXPECT_EQ(mode->interval.rate_hz(), 10.0);
  ASSERT_EQ(mode->warnings.size(), 1u);
  EXPECT_THAT(mode->warnings[0], HasSubstr("10/s instead of 30/s"));
}

TEST(V4l2Negotiation, CompressedAloneIsRefusedWithTheReason) {
  const auto mode = negotiate_v4l2(uvc_webcam_offer(), ask(1920, 1080, 30));
  ASSERT_FALSE(mode.ok());
  EXPECT_THAT(mode.error().message, HasSubstr("only compressed frames are offered at 1920x1080"));
  EXPECT_THAT(mode.error().message, HasSubstr("YUYV 1280x720 at 10, 5/s"));
  const auto named = negotiate_v4l2(uvc_webcam_offer(), ask(640, 480, 30, "MJPG"));
  ASSERT_FALSE(named.ok());
  EXPECT_THAT(named.error().message, HasSubstr("not decoded"));
}

TEST(V4l2Negotiation, MissingSizeListsWhatIsOffered) {
  const auto mode = negotiate_v4l2(uvc_webcam_offer(), ask(800, 600, 30));
  ASSERT_FALSE(mode.ok());
  EXPECT_EQ(mode.error().message,
            "/dev/video0 (USB 2.0 Camera: USB Camera): asked for 800x600 at 30/s, format auto; "
            "800x600 is not offered: ask for one of the sizes below. The device offers: MJPG "
            "(compressed) 1920x1080 at 30/s, 1280x720 at 60, 30/s, 640x480 at 120, 60, 30/s; YUYV "
            "1280x720 at 10, 5/s, 640x480 at 30, 20, 15, 10/s, 320x240 at 30/s.");
}

TEST(V4l2Negotiation, NamedFormatMustBeOfferedAndReadable) {
  const auto missing = negotiate_v4l2(uvc_webcam_offer(), ask(640, 480, 30, "GREY"));
  ASSERT_FALSE(missing.ok());
  EXPECT_THAT(missing.error().message, HasSubstr("the format 'GREY' is not offered"));
  const auto unreadable = negotiate_v4l2(vivid_offer(), ask(640, 480, 25, "RGBP"));
  ASSERT_FALSE(unreadable.ok());
  EXPECT_THAT(unreadable.error().message, HasSubstr("the format 'RGBP' cannot be read"));
  const auto named = negotiate_v4l2(vivid_offer(), ask(640, 480, 25, "UYVY"));
  ASSERT_TRUE(named.ok());
  EXPECT_EQ(named->fourcc, V4L2_PIX_FMT_UYVY);
}

TEST(V4l2Negotiation, MonoSensorGivesGreyAndItsRateIsUnknown) {
  const auto mode = negotiate_v4l2(mono_sensor_offer(), ask(1280, 800, 30));
  ASSERT_TRUE(mode.ok()) << mode.error().message;
  EXPECT_EQ(mode->fourcc, V4L2_PIX_FMT_GREY);
  EXPECT_FALSE(mode->interval.known());
}

TEST(V4l2Negotiation, AmongManyTheCheapestToRead) {
  const auto mode = negotiate_v4l2(vivid_offer(), ask(640, 480, 25));
  ASSERT_TRUE(mode.ok());
  EXPECT_EQ(mode->fourcc, V4L2_PIX_FMT_GREY);
}

TEST(V4l2Negotiation, ReachingTheRateComesBeforeCheapness) {
  V4l2Offer offer = vivid_offer();
  for (V4l2FormatOffer& format : offer.formats) {
    if (format.fourcc != V4L2_PIX_FMT_YUYV) format.sizes[2].rates.discrete = {{1, 10}};
  }
  EXPECT_EQ(negotiate_v4l2(offer, ask(640, 480, 25))->fourcc, V4L2_PIX_FMT_YUYV);
  EXPECT_EQ(negotiate_v4l2(offer, ask(640, 480, 10))->fourcc, V4L2_PIX_FMT_GREY);
}

TEST(V4l2Negotiation, RangesOfSizesAndRates) {
  const auto mode = negotiate_v4l2(isp_offer(), ask(1296, 968, 22.5));
  ASSERT_TRUE(mode.ok()) << mode.error().message;
  EXPECT_NEAR(mode->interval.rate_hz(), 22.5, 1e-9);
  EXPECT_EQ(negotiate_v4l2(isp_offer(), ask(640, 480, 200))->interval.rate_hz(), 60.0);
  EXPECT_EQ(negotiate_v4l2(isp_offer(), ask(640, 480, 1))->interval.rate_hz(), 5.0);
  const auto off_step = negotiate_v4l2(isp_offer(), ask(650, 480, 30));
  ASSERT_FALSE(off_step.ok());
  EXPECT_THAT(off_step.error().message, HasSubstr("NM12 32x16 to 4416x3312 at 5 to 60/s"));
}

TEST(V4l2Negotiation, NtscRatesPassForWholeOnes) {
  V4l2Rates rates;
  rates.discrete = {{1001, 60000}, {1001, 30000}, {1001, 15000}};
  EXPECT_NEAR(choose_interval(rates, 30.0).rate_hz(), 29.97, 0.01);
}

TEST(V4l2Negotiation, UnsaidSizesAreLeftToTheDriver) {
  V4l2Offer offer = mono_sensor_offer();
  for (V4l2FormatOffer& format : offer.formats) format.sizes.clear();
  EXPECT_TRUE(negotiate_v4l2(offer, ask(123, 45, 30)).ok());
}

TEST(V4l2Negotiation, BayerAloneNamesLibcamera) {
  V4l2Offer offer = mono_sensor_offer();
  offer.formats = {{V4L2_PIX_FMT_SGRBG10, false, "10-bit Bayer", {}}};
  const auto mode = negotiate_v4l2(offer, ask(640, 480, 30));
  ASSERT_FALSE(mode.ok());
  EXPECT_THAT(mode.error().message, HasSubstr("libcamera"));
}

}  // namespace
}  // namespace zenith
