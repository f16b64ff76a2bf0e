#include "tests/contract/camera_rigs.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>

#include "drivers/camera/libcamera_driver.h"
#include "drivers/camera/simulated_camera.h"
#include "drivers/camera/v4l2_camera.h"
#include "platform/linux/clock.h"
#include "platform/linux/unique_fd.h"
#include "tests/contract/video_device.h"
#include "tests/unit/drivers/camera/fake_v4l2.h"

namespace zenith {
namespace {

V4l2Settings settings_for(const std::string& device, double rate_hz) {
  V4l2Settings settings;
  settings.device = device;
  settings.rate_hz = rate_hz;
  return settings;
}

class FakeKernelRig final : public CameraRig {
 public:
  Camera& camera() override { return camera_; }
  int width_px() const override { return 640; }
  int height_px() const override { return 480; }
  Time now() const override { return kernel_.now(); }
  void let_frames_come(int count) override {
    const bool still = device_.frozen;
    device_.frozen = false;
    const std::uint64_t end = device_.produced + static_cast<std::uint64_t>(count);
    while (device_.produced < end) kernel_.advance({1'000'000});
    device_.frozen = still;
  }
  bool is_exact() const override { return true; }
  void hold_still(bool still) override { device_.frozen = still; }
  bool can_fail() const override { return true; }
  void set_plugged(bool plugged) override { device_.present = plugged; }

 private:
  mutable FakeV4l2 kernel_;
  FakeDevice& device_ = kernel_.add(vivid_offer());
  V4l2Camera camera_{settings_for(device_.offer.path, 25.0), kernel_};
};

// A thread that sends a frame every three milliseconds, each of another grey.
class SimulatedRig final : public CameraRig {
 public:
  ~SimulatedRig() override {
    stop_.store(true);
    sender_.join();
  }
  Camera& camera() override { return camera_; }
  int width_px() const override { return kWidth_px; }
  int height_px() const override { return kHeight_px; }
  Time now() const override { return monotonic_now(); }
  void let_frames_come(int count) override {
    const std::lock_guard lock(mutex_);
    for (int i = 0; i < count; ++i) send();
  }
  bool is_exact() const override { return true; }
  void hold_still(bool still) override {
    const std::lock_guard lock(mutex_);
    still_ = still;
  }
  bool can_fail() const override { return true; }
  void set_plugged(bool plugged) override {
    hold_still(!plugged);
    camera_.set_plugged(plugged);
  }

 private:
  static constexpr int kWidth_px = 64;
  static constexpr int kHeight_px = 48;

  void run() {
    while (!stop_.load()) {
      {
        const std::lock_guard lock(mutex_);
        if (!still_) send();
      }
      sleep_until(monotonic_now() + Duration{3'000'000});
    }
  }
  void send() {
    pixels_.assign(std::size_t{kWidth_px} * kHeight_px, ++value_);
    camera_.deliver(monotonic_now(), pixels_);
  }

  SimulatedCamera camera_{kWidth_px, kHeight_px, "simulated", [] {}};
  std::mutex mutex_;
  bool still_ = false;
  std::vector<std::uint8_t> pixels_;
  std::uint8_t value_ = 0;
  std::atomic<bool> stop_ = false;
  std::thread sender_{[this] { run(); }};
};

class KernelRig final : public CameraRig {
 public:
  std::string missing() const override { return device_.missing(); }
  Camera& camera() override { return camera_; }
  int width_px() const override { return 640; }
  int height_px() const override { return 480; }
  Time now() const override { return monotonic_now(); }
  void let_frames_come(int count) override {
    sleep_until(monotonic_now() + Duration::from_seconds(count / kRate_hz));
  }
  bool can_fail() const override { return true; }
  void set_plugged(bool plugged) override { device_.set_plugged(plugged); }

 private:
  static constexpr double kRate_hz = 10.0;

  VideoDevice device_;
  V4l2Camera camera_{settings_for(device_.path(), kRate_hz)};
};

// vimc, for one: colours, and sizes that are multiples of six.
class LibcameraRig final : public CameraRig {
 public:
  LibcameraRig() {
    const char* name = std::getenv("ZENITH_TEST_LIBCAMERA");
    if (name == nullptr || *name == '\0') {
      missing_ = "no camera of libcamera: ZENITH_TEST_LIBCAMERA is not set";
      return;
    }
    V4l2Settings settings = settings_for(name, kRate_hz);
    settings.width = settings.height = kSide_px;
    settings.first_frame_s = 20.0;
    auto camera = make_libcamera_camera(settings);
    if (camera) {
      camera_ = std::move(*camera);
    } else {
      ADD_FAILURE() << camera.error().message;
      missing_ = camera.error().message;
    }
  }
  std::string missing() const override { return missing_; }
  Camera& camera() override { return *camera_; }
  int width_px() const override { return kSide_px; }
  int height_px() const override { return kSide_px; }
  Time now() const override { return monotonic_now(); }
  void let_frames_come(int count) override {
    sleep_until(monotonic_now() + Duration::from_seconds(count / kRate_hz));
  }
  void change_picture() override { set_brightness(bright_ = !bright_); }

 private:
  static constexpr double kRate_hz = 10.0;
  static constexpr int kSide_px = 240;

  // Of vimc's sensor, whose picture stands still. A real camera has no such node, and noise.
  static void set_brightness(bool bright) {
    const std::string name = std::getenv("ZENITH_TEST_LIBCAMERA");
    for (const auto& entry : std::filesystem::directory_iterator("/sys/class/video4linux")) {
      std::string has;
      std::getline(std::ifstream(entry.path() / "name"), has);
      if (has != name) continue;
      const UniqueFd fd(::open(("/dev" / entry.path().filename()).c_str(), O_RDWR | O_CLOEXEC));
      v4l2_control control = {V4L2_CID_BRIGHTNESS, bright ? 200 : 60};
      ASSERT_EQ(::ioctl(fd.get(), VIDIOC_S_CTRL, &control), 0) << entry.path();
    }
  }

  bool bright_ = false;

  std::string missing_;
  std::unique_ptr<Camera> camera_;
};

template <typename Rig>
std::unique_ptr<CameraRig> make_rig() {
  return std::make_unique<Rig>();
}

}  // namespace

const std::vector<NamedCameraRig>& camera_rigs() {
  static const std::vector<NamedCameraRig> rigs = {{"V4l2OnFakeKernel", make_rig<FakeKernelRig>},
                                                   {"Simulated", make_rig<SimulatedRig>},
#ifdef ZENITH_WITH_RECORDINGS
                                                   {"Replayed", make_replayed_rig},
#endif
                                                   {"V4l2OnKernel", make_rig<KernelRig>},
                                                   {"Libcamera", make_rig<LibcameraRig>}};
  return rigs;
}

}  // namespace zenith
