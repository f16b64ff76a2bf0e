#include "platform/daemon/simulated/simulated_devices.h"

#include <array>
#include <string>
#include <utility>

#include "drivers/odometry/agilex_v2.h"
#include "platform/daemon/simulated/device_player.h"
#include "sim/simulation.h"
#include "sim/view_angle.h"
#include "sim/world.h"

namespace zenith {
namespace {

Result<std::size_t> find_robot(const sim::Simulation& simulation, const std::string& name) {
  const auto& robots = simulation.world().file.robots;
  if (name.empty()) return std::size_t{0};
  std::string known;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (robots[i].name == name) return i;
    known += (known.empty() ? "" : ", ") + robots[i].name;
  }
  return Error{"simulation.robot '" + name + "' is not in the world " + simulation.name() +
               "; there are " + known};
}

// Drives once along its way.
class SimulatedSource final : public MomentSource {
 public:
  SimulatedSource(sim::Simulation simulation, std::size_t robot)
      : simulation_(std::move(simulation)), drive_(simulation_.drive(robot)) {}

  const RobotConfig& config() const { return drive_.config(); }

  bool next(Moment& moment) override {
    frame_.pixels.swap(moment.pixels);
    if (!drive_.next(frame_, moment.can)) return false;
    frame_.pixels.swap(moment.pixels);
    moment.stamp = frame_.stamp;
    moment.frame = MomentFrame::kGood;
    for (const CanFrame& frame : moment.can) {
      standing_[frame.id == agilex_v2::kOdometerId ? 0 : 1] = frame;
    }
    return true;
  }
  Duration frame_period() const override {
    return Duration::from_seconds(1.0 / drive_.config().frame_rate_hz);
  }
  std::vector<CanFrame> standing() const override {
    CanFrame motion = standing_[1];
    motion.data = {};
    return {standing_[0], motion};
  }

 private:
  sim::Simulation simulation_;  // the drive looks into it
  sim::RobotDrive drive_;
  sim::SimFrame frame_;
  std::array<CanFrame, 2> standing_;  // the last odometer and motion frame
};

}  // namespace

Result<Devices> make_simulated_devices(const DaemonConfig& config) {
  sim::SimOptions options;
  options.seed = config.simulation.seed;
  options.frame_rate_hz = config.simulation.frame_rate_hz;
  auto loaded = sim::load_what_is_seen(sim::find_world(config.simulation.world), options,
                                       config.slam.rectified_fov_deg);
  if (!loaded) return loaded.error();
  const auto index = find_robot(*loaded, config.simulation.robot);
  if (!index) return index.error();
  const std::string description = "simulated robot " + loaded->world().file.robots[*index].name +
                                  " in the world " + loaded->name();
  const auto decoder = make_wheel_decoder(config.odometry);
  if (!decoder) return decoder.error();
  auto source = std::make_unique<SimulatedSource>(std::move(*loaded), *index);
  const RobotConfig robot = source->config();
  return make_played_devices(std::move(source), robot, *decoder, description);
}

Result<Devices> make_any_devices(const DaemonConfig& config) {
  switch (config.camera_driver) {
    case CameraDriver::kSimulated:
      return make_simulated_devices(config);
    case CameraDriver::kReplay:
      return make_replayed_devices(config);
    default:
      return make_real_devices(config);
  }
}

}  // namespace zenith
