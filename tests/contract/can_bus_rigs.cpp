#include "tests/contract/can_bus_rigs.h"

#include <linux/can/error.h>

#include <algorithm>

#include "drivers/odometry/replayed_can.h"
#include "drivers/odometry/simulated_can.h"
#include "drivers/odometry/socket_can.h"
#include "platform/linux/clock.h"
#include "tests/contract/can_sender.h"
#include "tests/unit/drivers/odometry/fake_can.h"

namespace zenith {
namespace {

can_frame raw_frame(const CanFrame& frame) {
  can_frame raw = {};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0);
  raw.can_dlc = frame.length;
  std::copy(frame.data.begin(), frame.data.end(), raw.data);
  return raw;
}

can_frame bus_off_frame(bool off) {
  can_frame raw = {};
  raw.can_id = CAN_ERR_FLAG | (off ? CAN_ERR_BUSOFF : CAN_ERR_RESTARTED);
  raw.can_dlc = CAN_ERR_DLC;
  return raw;
}

class FakeKernelRig final : public CanBusRig {
 public:
  FakeKernelRig() { kernel_.plug("can0"); }
  std::unique_ptr<CanBus> make(const CanIds& ids, const std::vector<CanFrame>& frames) override {
    frames_ = frames;
    return std::make_unique<SocketCanBus>(SocketCanSettings{"can0", ids}, kernel_);
  }
  void send() override {
    for (const CanFrame& frame : frames_) {
      kernel_.advance({100'000});
      kernel_.send("can0", raw_frame(frame));
    }
  }
  Time now() const override { return kernel_.now(); }
  void set_up(bool up) override { kernel_.set_up("can0", up); }
  void set_bus_off(bool off) override { kernel_.send("can0", bus_off_frame(off)); }

 private:
  mutable FakeCan kernel_;
  std::vector<CanFrame> frames_;
};

class SimulatedRig final : public CanBusRig {
 public:
  std::unique_ptr<CanBus> make(const CanIds& ids, const std::vector<CanFrame>& frames) override {
    frames_ = frames;
    auto bus = std::make_unique<SimulatedCanBus>(ids);
    bus_ = bus.get();
    return bus;
  }
  void send() override {
    for (CanFrame frame : frames_) {
      frame.stamp = monotonic_now();
      bus_->send(frame);
    }
  }
  Time now() const override { return monotonic_now(); }
  void set_up(bool up) override { bus_->set_up(up); }
  void set_bus_off(bool off) override { bus_->set_bus_off(off); }

 private:
  SimulatedCanBus* bus_ = nullptr;
  std::vector<CanFrame> frames_;
};

class ReplayedRig final : public CanBusRig {
 public:
  std::unique_ptr<CanBus> make(const CanIds& ids, const std::vector<CanFrame>& frames) override {
    begin_ = monotonic_now() + lead_;
    lead_ = {2 * lead_.ns};
    const ReplayTiming timing = {Time{77'000}, begin_};
    std::vector<CanFrame> recorded = frames;
    for (std::size_t i = 0; i < recorded.size(); ++i) {
      recorded[i].stamp = timing.recorded + Duration{static_cast<std::int64_t>(i) * 100'000};
    }
    return std::make_unique<ReplayedCanBus>(recorded, timing, ids);
  }
  void send() override {}
  bool plays_already() const override { return monotonic_now() >= begin_; }
  Time now() const override { return monotonic_now(); }
  bool can_fail() const override { return false; }
  void set_up(bool) override {}
  void set_bus_off(bool) override {}

 private:
  Duration lead_ = {150'000'000};
  Time begin_;
};

class KernelRig final : public CanBusRig {
 public:
  ~KernelRig() override {
    if (missing().empty()) sender_.set_up(true);
  }
  std::string missing() const override { return sender_.missing(); }
  std::unique_ptr<CanBus> make(const CanIds& ids, const std::vector<CanFrame>& frames) override {
    frames_ = frames;
    return std::make_unique<SocketCanBus>(SocketCanSettings{sender_.interface(), ids});
  }
  void send() override {
    for (const CanFrame& frame : frames_) sender_.send(raw_frame(frame));
  }
  Time now() const override { return monotonic_now(); }
  void set_up(bool up) override { sender_.set_up(up); }
  void set_bus_off(bool off) override { sender_.send(bus_off_frame(off)); }

 private:
  CanSender sender_;
  std::vector<CanFrame> frames_;
};

template <typename Rig>
std::unique_ptr<CanBusRig> make_rig() {
  return std::make_unique<Rig>();
}

}  // namespace

const std::vector<NamedRig>& can_bus_rigs() {
  static const std::vector<NamedRig> rigs = {{"SocketOnFakeKernel", make_rig<FakeKernelRig>},
                                             {"Simulated", make_rig<SimulatedRig>},
                                             {"Replayed", make_rig<ReplayedRig>},
                                             {"SocketOnVirtualCan", make_rig<KernelRig>}};
  return rigs;
}

}  // namespace zenith
