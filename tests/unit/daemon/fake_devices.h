#pragma once
// A camera and a base without a world, for tests of the perception thread: a ceiling of tiles seen
// from where the wheels say, as fast as the test asks.

#include <algorithm>
#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "drivers/camera/simulated_camera.h"
#include "drivers/odometry/agilex_v2.h"
#include "drivers/odometry/simulated_can.h"
#include "platform/daemon/devices.h"
#include "platform/linux/clock.h"
#include "slam/image/lens.h"
#include "tests/support/hall.h"

namespace zenith {

// What an AgileX base sends.
inline CanFrame odometer_frame(Time stamp, std::int32_t left_mm, std::int32_t right_mm) {
  CanFrame frame;
  frame.stamp = stamp;
  frame.id = agilex_v2::kOdometerId;
  frame.length = 8;
  for (int i = 0; i < 4; ++i) {
    const int shift = 24 - 8 * i;
    frame.data[i] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(left_mm) >> shift);
    frame.data[i + 4] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(right_mm) >> shift);
  }
  return frame;
}

class FakeRobot {
 public:
  static constexpr double kRate_hz = 20.0;

  FakeRobot() {
    devices.robot.frame_rate_hz = kRate_hz;
    const Lens& lens = devices.robot.lens;
    auto made_camera =
        std::make_unique<SimulatedCamera>(lens.width_px, lens.height_px, "fake", [] {});
    auto made_can = std::make_unique<SimulatedCanBus>();
    camera = made_camera.get();
    can = made_can.get();
    devices.camera = std::move(made_camera);
    devices.can = std::move(made_can);
    pixels_.resize(static_cast<std::size_t>(lens.width_px) * lens.height_px);
  }
  ~FakeRobot() { stop(); }

  // Drives in a thread of its own until stop().
  void drive() {
    driver_ = std::thread([this] {
      int millimetres = 0;
      for (int i = 0; !stop_.load(); ++i, millimetres += stands.load() ? 0 : 2) {
        sleep_until(monotonic_now() + Duration{10'000'000});
        if (i % 5 == 0) {
          if (!freezes.load()) paint(millimetres);
          camera->deliver(monotonic_now(), pixels_);
        }
        if (wheels_on.load()) can->send(odometer_frame(monotonic_now(), millimetres, millimetres));
      }
    });
  }
  void stop() {
    stop_.store(true);
    if (driver_.joinable()) driver_.join();
  }

  Devices devices;
  SimulatedCamera* camera = nullptr;
  SimulatedCanBus* can = nullptr;
  std::atomic<bool> wheels_on = true;
  std::atomic<bool> stands = false;   // the wheels go on telling, but do not turn
  std::atomic<bool> freezes = false;  // frames come with new stamps, and show what the last one did

 private:
  void paint(int millimetres) {
    const ImageView seen = hall_.seen_from({1e-3 * millimetres, 0.0, 0.0});
    std::copy_n(seen.data, pixels_.size(), pixels_.begin());
  }

  Hall hall_{devices.robot.lens};
  std::vector<std::uint8_t> pixels_;
  std::atomic<bool> stop_ = false;
  std::thread driver_;
};

}  // namespace zenith
