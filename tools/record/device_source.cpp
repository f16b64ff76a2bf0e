// The devices themselves, for when no daemon runs: calibration drives.

#include <array>
#include <utility>

#include "platform/daemon/tap/daemon_tap.h"
#include "tools/record/source.h"

namespace zenith::tools {
namespace {

constexpr Duration kSlice = {5'000'000};

class DeviceSource final : public RecordSource {
 public:
  DeviceSource(const DaemonConfig& config, Devices devices)
      : devices_(std::move(devices)), robot_(tap::describe_robot(config, devices_)) {}
  ~DeviceSource() override {
    devices_.camera->close();
    devices_.can->close();
  }

  Status begin() {
    if (const Status opened = devices_.can->open(); !opened) return opened;
    if (const Status opened = devices_.camera->open(); !opened) return opened;
    return {};
  }

  const tap::Hello& robot() const override { return robot_; }
  std::string description() const override {
    return devices_.camera->description() + "; " + devices_.can->description();
  }
  tap::End end() const override { return end_; }
  void finish() override { ended_ = true; }

  Result<bool> take(Duration wait, RecordSink& sink) override {
    if (ended_) return false;
    for (Duration left = wait; left.ns > 0; left = {left.ns - kSlice.ns}) {
      CameraFrame frame;
      const CameraWait result = devices_.camera->wait(kSlice, frame);
      if (result == CameraWait::kLost) {
        return Error{std::string("the camera is lost: ") + devices_.camera->lost_reason()};
      }
      if (const Status received = receive_can(sink); !received) return received.error();
      if (result != CameraWait::kFrame) continue;
      const Lens& lens = devices_.robot.lens;
      if (frame.luma.width != lens.width_px || frame.luma.height != lens.height_px) {
        return Error{"the camera gives frames of another size than [lens] says"};
      }
      ++end_.frames;
      sink.frame({frame.stamp, frame.sequence, frame.luma.width, frame.luma.height}, frame.luma);
    }
    return true;
  }

 private:
  Status receive_can(RecordSink& sink) {
    std::size_t count = 0;
    do {
      count = devices_.can->receive({0}, can_);
      if (count > 0) sink.can(std::span(can_).first(count));
      end_.can += count;
    } while (count == can_.size());
    end_.can_dropped = devices_.can->counters().dropped;
    const CanState state = devices_.can->state();
    if (state != CanState::kDown && state != CanState::kClosed) return {};
    return Error{std::string("the CAN bus is lost: ") + devices_.can->lost_reason()};
  }

  Devices devices_;
  const tap::Hello robot_;
  std::array<CanFrame, 256> can_;
  tap::End end_;
  bool ended_ = false;
};

}  // namespace

Result<std::unique_ptr<RecordSource>> open_device_source(const DaemonConfig& config,
                                                         Devices devices) {
  auto source = std::make_unique<DeviceSource>(config, std::move(devices));
  if (const Status begun = source->begin(); !begun) return begun.error();
  return std::unique_ptr<RecordSource>(std::move(source));
}

}  // namespace zenith::tools
