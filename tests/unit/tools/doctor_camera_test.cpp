// The checks of the camera, on devices that exist in memory only.

#include "tools/doctor/check_camera.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/camera/v4l2_camera.h"
#include "platform/base/random.h"
#include "tests/unit/drivers/camera/fake_v4l2.h"

namespace zenith::tools {
namespace {

MATCHER_P2(Says, verdict, text, "") {
  *result_listener << finding_line(arg, false);
  return arg.verdict == verdict && (arg.found + "; " + arg.todo).find(text) != std::string::npos;
}

class DoctorCameraTest : public testing::Test {
 protected:
  Findings check() { return check_camera_device(settings_, io_, path_); }

  FakeV4l2 io_;
  V4l2Settings settings_;
  std::string path_;
};

TEST_F(DoctorCameraTest, ADeviceThatIsNotThereOrNoCamera) {
  EXPECT_THAT(check().at(0), Says(Verdict::kFail, "/dev/video0"));
  settings_.device = "name:Fisheye";
  EXPECT_THAT(check().at(0), Says(Verdict::kFail, "no camera fits"));
  V4l2Offer idle = idle_loopback_offer();
  io_.add(idle);
  settings_.device = idle.path;
  EXPECT_THAT(check().at(0), Says(Verdict::kFail, "does not capture"));
  EXPECT_EQ(path_, "");
}

TEST_F(DoctorCameraTest, FormatSizeAndRate) {
  io_.add(uvc_webcam_offer());
  Findings findings = check();
  EXPECT_THAT(findings.at(0), Says(Verdict::kOk, "USB Camera"));
  EXPECT_THAT(findings.at(1), Says(Verdict::kOk, "YUYV 640x480 at 30/s"));
  EXPECT_EQ(path_, "/dev/video0");
  settings_.rate_hz = 60;
  EXPECT_THAT(check().at(1), Says(Verdict::kWarn, "rate"));
  settings_.width = 641;
  EXPECT_THAT(check().at(1), Says(Verdict::kFail, "641x480"));
  EXPECT_EQ(path_, "") << "it cannot stream as asked";
}

TEST_F(DoctorCameraTest, Controls) {
  FakeDevice& device = io_.add(uvc_webcam_offer());
  EXPECT_THAT(check().at(2), Says(Verdict::kOk, "left alone"));
  EXPECT_THAT(check().at(3), Says(Verdict::kOk, "none asked for"));
  settings_.exposure = V4l2Exposure::kManual;
  settings_.power_line = V4l2PowerLine::k50Hz;
  EXPECT_THAT(check().at(2), Says(Verdict::kWarn, "no exposure control"));
  EXPECT_THAT(check().at(3), Says(Verdict::kWarn, "no power line filter"));
  for (const std::uint32_t id : {V4L2_CID_EXPOSURE_ABSOLUTE, V4L2_CID_POWER_LINE_FREQUENCY}) {
    FakeControl control;
    control.id = id;
    control.max = 9;
    device.controls.push_back(control);
  }
  EXPECT_THAT(check().at(2), Says(Verdict::kOk, "can be set"));
  EXPECT_EQ(check().at(3).verdict, Verdict::kOk);
}

TEST_F(DoctorCameraTest, WhoElseHasIt) {
  EXPECT_THAT(check_camera_free({}, 0), Says(Verdict::kOk, "by nobody"));
  EXPECT_THAT(check_camera_free({{7, "zenithd"}}, 7), Says(Verdict::kOk, "by zenithd"));
  EXPECT_THAT(check_camera_free({{7, "zenithd"}, {8, "cheese"}}, 7),
              Says(Verdict::kWarn, "cheese (pid 8)"));
}

StreamFacts stream(int frames, double rate_hz) {
  StreamFacts facts;
  for (int i = 0; i < frames; ++i) {
    facts.stamps.push_back(Time{1'000'000'000} + Duration::from_seconds(i / rate_hz));
  }
  if (frames > 0) facts.last_received = facts.stamps.back() + Duration{20'000'000};
  return facts;
}

TEST_F(DoctorCameraTest, Rates) {
  EXPECT_THAT(check_camera_rate(stream(60, 30), 30), Says(Verdict::kOk, "30.0 frames"));
  EXPECT_EQ(check_camera_rate(stream(60, 25), 30).verdict, Verdict::kWarn);
  EXPECT_THAT(check_camera_rate(stream(60, 10), 30), Says(Verdict::kFail, "10.0 frames"));
  EXPECT_THAT(check_camera_rate(stream(2, 10), 30), Says(Verdict::kFail, "then none"));
  StreamFacts none;
  EXPECT_THAT(check_camera_rate(none, 30), Says(Verdict::kFail, "no frame came"));
  none.problem = "cannot open";
  EXPECT_THAT(check_camera_rate(none, 30), Says(Verdict::kFail, "cannot open"));
  StreamFacts damaged = stream(60, 30);
  damaged.counters.damaged = 3;
  EXPECT_THAT(check_camera_rate(damaged, 30), Says(Verdict::kWarn, "3 damaged"));
}

TEST_F(DoctorCameraTest, Stamps) {
  StreamFacts facts = stream(10, 30);
  EXPECT_THAT(check_camera_stamps(facts), Says(Verdict::kOk, "20 ms old"));
  facts.counters.stamps_replaced = 10;
  EXPECT_THAT(check_camera_stamps(facts), Says(Verdict::kWarn, "monotonic"));
  facts = stream(10, 30);
  facts.last_received = facts.stamps.back() + Duration{900'000'000};
  EXPECT_THAT(check_camera_stamps(facts), Says(Verdict::kWarn, "0.900 s old"));
  facts.stamps[5] = facts.stamps[4];
  EXPECT_THAT(check_camera_stamps(facts), Says(Verdict::kFail, "do not rise"));
  EXPECT_EQ(check_camera_stamps(stream(2, 30)).verdict, Verdict::kSkip);
}

// A picture of 160 x 120 pixels by a rule, with noise.
Finding verdict_on(const std::function<double(int, int)>& rule, double noise = 2.0) {
  constexpr int kWidth = 160;
  constexpr int kHeight = 120;
  Random random(7);
  std::vector<std::uint8_t> pixels;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const double value = rule(u, v) + noise * random.normal();
      pixels.push_back(static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0)));
    }
  }
  return check_picture(measure_picture({pixels.data(), kWidth, kHeight, kWidth}));
}

TEST_F(DoctorCameraTest, Pictures) {
  EXPECT_THAT(verdict_on([](int, int) { return 1.0; }), Says(Verdict::kFail, "black"));
  EXPECT_THAT(verdict_on([](int, int) { return 254.0; }), Says(Verdict::kFail, "white"));
  EXPECT_THAT(verdict_on([](int, int) { return 120.0; }), Says(Verdict::kFail, "one grey"));
  // Out of focus: nothing but a slope from one side to the other.
  EXPECT_THAT(verdict_on([](int u, int) { return 90.0 + 0.1 * u; }),
              Says(Verdict::kWarn, "hardly any detail"));
  const auto tiles = [](int u, int v) { return (u / 12 + v / 12) % 2 == 0 ? 90.0 : 130.0; };
  EXPECT_EQ(verdict_on(tiles).verdict, Verdict::kOk);
  EXPECT_THAT(verdict_on([&](int u, int v) { return u < 60 ? 255.0 : tiles(u, v); }),
              Says(Verdict::kWarn, "is white"));
}

}  // namespace
}  // namespace zenith::tools
