#pragma once
// A simulated robot that drives in real time: one thread renders its frames ahead, another sends
// CAN frames and frames at their moments. Both are outside of the perception thread, as devices
// are.
//
// The world's clock is CLOCK_MONOTONIC less an offset. Where the computer renders more slowly than
// frames are due the offset grows: the robot then drives more slowly, but wheels and camera agree.
// At the end of its way the robot stands, and its devices go on.

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/camera/simulated_camera.h"
#include "drivers/odometry/simulated_can.h"
#include "platform/daemon/devices.h"
#include "platform/linux/spsc_queue.h"
#include "platform/linux/thread.h"
#include "sim/simulation.h"

namespace zenith {

class SimulatedRobot final : public DeviceWorld {
 public:
  SimulatedRobot(sim::Simulation simulation, std::size_t robot);
  ~SimulatedRobot() override;

  // Both must outlive it.
  void connect(SimulatedCamera& camera, SimulatedCanBus& can);
  // From the first call on the robot drives. Any one thread.
  void start();

  const RobotConfig& config() const { return drive_.config(); }
  // By how much the world is slower than real time by now.
  Duration behind() const { return {behind_ns_.load(std::memory_order_relaxed)}; }

 private:
  static constexpr std::size_t kAhead = 8;  // rendered frames that wait for their moment

  struct Moment {
    sim::SimFrame frame;
    std::vector<CanFrame> can;
    bool last = false;
  };

  void render();
  void play();
  bool wait_for_moment(std::size_t& slot);
  void play_moment(const Moment& moment);
  void stand();
  void send(CanFrame frame);
  bool stopping() const { return stop_.load(std::memory_order_relaxed); }

  sim::Simulation simulation_;  // the drive looks into it
  sim::RobotDrive drive_;
  SimulatedCamera* camera_ = nullptr;
  SimulatedCanBus* can_ = nullptr;

  std::array<Moment, kAhead> moments_;
  SpscQueue<std::size_t, kAhead> free_;
  SpscQueue<std::size_t, kAhead> ready_;
  std::atomic<bool> stop_ = false;
  std::atomic<std::int64_t> behind_ns_ = 0;
  Duration offset_;       // of the playing thread
  CanFrame last_can_[2];  // the last odometer and motion frame
  Thread renderer_;
  Thread player_;
};

// What zenithd-sim makes: simulated devices, or real ones.
Result<Devices> make_any_devices(const DaemonConfig& config);
Result<Devices> make_simulated_devices(const DaemonConfig& config);

}  // namespace zenith
