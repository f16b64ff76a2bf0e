#ifdef ZENITH_WITH_RECORDINGS

#include "platform/daemon/simulated/simulated_devices.h"
#include "platform/linux/clock.h"
#include "tests/contract/camera_rigs.h"
#include "tests/unit/tools/small_recording.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

constexpr double kSpeed = 5.0;  // 50 frames a second

class ReplayedRig final : public CameraRig {
 public:
  ReplayedRig() {
    const auto recording = folder_.path() / "rec";
    tools::write_small_recording(recording);
    DaemonConfig config;
    config.replay = {recording.string(), kSpeed, true};
    auto devices = make_replayed_devices(config);
    if (!devices) {
      ADD_FAILURE() << devices.error().message;
      return;
    }
    devices_ = std::move(*devices);
  }
  Camera& camera() override { return *devices_.camera; }
  int width_px() const override { return tools::small_robot().lens.width_px; }
  int height_px() const override { return tools::small_robot().lens.height_px; }
  Time now() const override { return monotonic_now(); }
  void let_frames_come(int count) override {
    const double rate_hz = tools::small_robot().frame_rate_hz * kSpeed;
    sleep_until(monotonic_now() + Duration::from_seconds(count / rate_hz));
  }

 private:
  tools::TemporaryFolder folder_;
  Devices devices_;
};

}  // namespace

std::unique_ptr<CameraRig> make_replayed_rig() {
  return std::make_unique<ReplayedRig>();
}

}  // namespace zenith

#endif
