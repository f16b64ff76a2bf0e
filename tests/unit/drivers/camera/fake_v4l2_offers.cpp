#include <linux/videodev2.h>

#include "tests/unit/drivers/camera/fake_v4l2.h"

namespace zenith {
namespace {

V4l2SizeOffer size(std::uint32_t width, std::uint32_t height, std::vector<std::uint32_t> rates_hz) {
  V4l2SizeOffer offer = {width, width, 1, height, height, 1, {}};
  for (const std::uint32_t rate_hz : rates_hz) offer.rates.discrete.push_back({1, rate_hz});
  return offer;
}

V4l2Offer camera(const char* path, const char* driver, const char* card, const char* bus) {
  V4l2Offer offer;
  offer.path = path;
  offer.driver = driver;
  offer.card = card;
  offer.bus = bus;
  offer.captures = true;
  offer.streams = true;
  return offer;
}

}  // namespace

V4l2Offer uvc_webcam_offer() {
  V4l2Offer offer =
      camera("/dev/video0", "uvcvideo", "USB 2.0 Camera: USB Camera", "usb-0000:01:00.0-1.2");
  offer.formats = {
      {V4L2_PIX_FMT_MJPEG,
       true,
       "Motion-JPEG",
       {size(1920, 1080, {30}), size(1280, 720, {60, 30}), size(640, 480, {120, 60, 30})}},
      {V4L2_PIX_FMT_YUYV,
       false,
       "YUYV 4:2:2",
       {size(1280, 720, {10, 5}), size(640, 480, {30, 20, 15, 10}), size(320, 240, {30})}}};
  return offer;
}

V4l2Offer mono_sensor_offer() {
  V4l2Offer offer = camera("/dev/video0", "unicam", "unicam", "platform:fe801000.csi");
  offer.formats = {{V4L2_PIX_FMT_Y10, false, "10-bit Greyscale", {size(1280, 800, {})}},
                   {V4L2_PIX_FMT_GREY, false, "8-bit Greyscale", {size(1280, 800, {})}}};
  return offer;
}

V4l2Offer vivid_offer() {
  V4l2Offer offer = camera("/dev/video50", "vivid", "vivid", "platform:vivid-000");
  const std::vector<V4l2SizeOffer> sizes = {size(320, 180, {60, 50, 30, 25, 15, 10}),
                                            size(640, 360, {60, 50, 30, 25, 15, 10}),
                                            size(640, 480, {25, 15, 10})};
  offer.formats = {{V4L2_PIX_FMT_YUYV, false, "YUYV 4:2:2", sizes},
                   {V4L2_PIX_FMT_UYVY, false, "UYVY 4:2:2", sizes},
                   {V4L2_PIX_FMT_NV12, false, "Y/UV 4:2:0", sizes},
                   {V4L2_PIX_FMT_GREY, false, "8-bit Greyscale", sizes},
                   {V4L2_PIX_FMT_RGB24, false, "24-bit RGB 8-8-8", sizes}};
  return offer;
}

V4l2Offer idle_loopback_offer() {
  V4l2Offer offer = camera("/dev/video42", "v4l2 loopback", "Dummy video device (0x0000)",
                           "platform:v4l2loopback-000");
  offer.captures = false;
  offer.has_output = true;
  return offer;
}

V4l2Offer isp_offer() {
  V4l2Offer offer = camera("/dev/video0", "rkisp1", "rkisp1_mainpath", "platform:rkisp1");
  offer.multiplanar = true;
  V4l2SizeOffer range = {32, 4416, 16, 16, 3312, 8, {}};
  range.rates.shortest = {1, 60};
  range.rates.longest = {1, 5};
  offer.formats = {{V4L2_PIX_FMT_NV12M, false, "Y/UV 4:2:0 (N-C)", {range}}};
  return offer;
}

}  // namespace zenith
