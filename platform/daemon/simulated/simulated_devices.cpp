#include <algorithm>
#include <string>
#include <utility>

#include "platform/daemon/simulated/simulated_robot.h"
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
  auto decoder = make_wheel_decoder(config.odometry);
  if (!decoder) return decoder.error();
  auto robot = std::make_unique<SimulatedRobot>(std::move(*loaded), *index);
  Devices devices;
  devices.robot = robot->config();
  devices.decoder = *decoder;
  devices.description = description;
  const Lens& lens = devices.robot.lens;
  auto camera = std::make_unique<SimulatedCamera>(
      lens.width_px, lens.height_px,
      "simulated, GREY " + std::to_string(lens.width_px) + "x" + std::to_string(lens.height_px),
      [world = robot.get()] { world->start(); });
  auto can = std::make_unique<SimulatedCanBus>(decoder->ids());
  robot->connect(*camera, *can);
  devices.camera = std::move(camera);
  devices.can = std::move(can);
  devices.world = std::move(robot);
  return devices;
}

Result<Devices> make_any_devices(const DaemonConfig& config) {
  return config.is_simulated() ? make_simulated_devices(config) : make_real_devices(config);
}

}  // namespace zenith
