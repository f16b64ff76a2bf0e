// Textures, sensor and motion blur: the numbers behind the pictures.

#include <cmath>

#include "sim/canvas.h"
#include "sim/sensor.h"
#include "sim/simulation.h"
#include "sim/texture.h"
#include "tests/unit/sim/test_world.h"

namespace zenith::sim {
namespace {

TEST(Texture, BilinearIsExactOnARamp) {
  std::vector<float> ramp;
  for (int j = 0; j < 32; ++j) {
    for (int i = 0; i < 64; ++i) ramp.push_back(0.01F * static_cast<float>(i + 2 * j));
  }
  const Texture texture(64, 32, 0.01F, ramp);
  // A coordinate means the same place on every level; texel centres lie at a half.
  for (int level = 0; level < 3; ++level) {
    for (float s = 8.0F; s < 50.0F; s += 3.7F) {
      const float expected = 0.01F * ((s - 0.5F) + 2.0F * (13.2F - 0.5F));
      EXPECT_NEAR(texture.at(level, s, 13.2F), expected, 0.002F) << level << " " << s;
    }
  }
  EXPECT_NEAR(texture.at(0, -100.0F, -100.0F), ramp.front(), 0.0003F);
  EXPECT_NEAR(texture.at(0, 1e4F, 1e4F), ramp.back(), 0.0003F);
}

TEST(Canvas, CoverageKeepsAreaAndPlace) {
  Canvas canvas(1.0, 1.0, 0.01, 0.0);
  canvas.rect({0.2034, 0.3071, 0.7512, 0.6429}, paint(1.0));
  double sum = 0.0;
  double moment_x = 0.0;
  for (int j = 0; j < canvas.rows(); ++j) {
    for (int i = 0; i < canvas.columns(); ++i) {
      const double value = static_cast<double>(canvas.row(j)[i]);
      sum += value;
      moment_x += value * (i + 0.5) * 0.01;
    }
  }
  EXPECT_NEAR(sum * 1e-4, 0.5478 * 0.3358, 1e-6);
  EXPECT_NEAR(moment_x / sum, 0.5 * (0.2034 + 0.7512), 1e-4);
}

// 640 x 480 pixels of one level: mean within 0.01, deviation within 1 % (its standard error from
// 300 000 samples is 0.13 %; the table of noise repeats, and rounding adds 1/12).
TEST(Sensor, NoiseFollowsShotAndReadNoise) {
  CameraSpec camera;
  camera.blur_px = 0.5;
  Sensor sensor(camera, 0.0);
  const std::vector<float> radiance(640 * 480, 0.5F);
  std::vector<std::uint8_t> pixels;
  Random random(3);
  sensor.develop(radiance, random, pixels);
  double sum = 0.0;
  double sum2 = 0.0;
  int count = 0;
  for (int v = 1; v < 479; ++v) {
    for (int u = 1; u < 639; ++u) {
      const double value = pixels[static_cast<std::size_t>(v) * 640 + u];
      sum += value;
      sum2 += value * value;
      ++count;
    }
  }
  const double mean = sum / count;
  const double per_e = 255.0 / camera.full_well_e;
  const double expected =
      std::sqrt(100.0 * per_e + std::pow(camera.read_noise_e * per_e, 2) + 1.0 / 12.0);
  EXPECT_NEAR(mean, 100.0, 0.02);
  EXPECT_NEAR(std::sqrt(sum2 / count - mean * mean), expected, 0.01 * expected);
}

TEST(Sensor, ClipsAndScalesWithExposure) {
  const CameraSpec camera;
  Random random(1);
  std::vector<std::uint8_t> pixels;
  Sensor(camera, 0.0).develop(std::vector<float>(640 * 480, 3.0F), random, pixels);
  EXPECT_EQ(pixels[1000], 255);
  Sensor(camera, -2.0).develop(std::vector<float>(640 * 480, 1.0F), random, pixels);
  EXPECT_NEAR(pixels[240 * 640 + 320], 50, 6);
  Sensor(camera, 0.0).develop(std::vector<float>(640 * 480, 0.0F), random, pixels);
  EXPECT_LE(pixels[1000], 2);
}

// A long exposure smears edges while driving and changes nothing while standing. At 0.46 m/s, 60 ms
// are 1.8 px on a ceiling 2.3 m above. Against the blur of pixel and texel (variance 0.15 px2) a
// pixel half a pixel from a lamp's edge changes by Phi(0.5 / 0.39) - Phi(0.5 / 0.65) = 0.12 of the
// step of 60.
TEST(MotionBlur, SmearsOnlyWhenMoving) {
  const auto render = [](const std::string& exposure, int frame_index) {
    const TestWorld file(exact_room("exposure_ms = " + exposure + "\n"));
    auto simulation = Simulation::load(file.path(), {.max_view_angle_deg = 60.0});
    RobotDrive drive = simulation->drive(0);
    SimFrame frame;
    std::vector<CanFrame> can;
    for (int i = 0; i <= frame_index; ++i) EXPECT_TRUE(drive.next(frame, can));
    return frame.pixels;
  };
  const auto difference = [](const auto& a, const auto& b) {
    int most = 0;
    for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
    return most;
  };
  EXPECT_EQ(difference(render("0", 5), render("60", 5)), 0);
  EXPECT_GT(difference(render("0", 35), render("60", 35)), 5);
}

}  // namespace
}  // namespace zenith::sim
