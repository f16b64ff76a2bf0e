#include "tools/runner/simulated_source.h"

#include <utility>

#include "drivers/odometry/wheel_decoder.h"
#include "platform/recording/wheel_queue.h"
#include "sim/simulation.h"
#include "sim/view_angle.h"

namespace zenith::tools {
namespace {

class SimulatedSource : public Source {
 public:
  SimulatedSource(std::shared_ptr<const sim::Simulation> simulation, std::size_t robot)
      : simulation_(std::move(simulation)), drive_(simulation_->drive(robot)) {}

  const std::string& name() const override { return drive_.name(); }
  const RobotConfig& config() const override { return drive_.config(); }
  int frame_count() const override { return drive_.frame_count(); }

  Result<bool> next(SourceFrame& frame) override {
    if (!drive_.next(rendered_, can_)) return false;
    for (const CanFrame& message : can_) {
      if (const auto sample = decoder_.decode(message)) wheels_.push(*sample);
    }
    frame.stamp = rendered_.stamp;
    frame.truth = rendered_.T_world_robot;
    std::swap(frame.pixels, rendered_.pixels);
    wheels_.take(frame.stamp, frame.wheels);
    return true;
  }

 private:
  std::shared_ptr<const sim::Simulation> simulation_;  // the drive looks into it
  sim::RobotDrive drive_;
  sim::SimFrame rendered_;
  std::vector<CanFrame> can_;
  WheelDecoder decoder_;
  WheelQueue wheels_;
};

}  // namespace

Result<SimulatedTeam> simulate_team(const std::string& world, std::uint64_t seed, double duration_s,
                                    const Parameters& parameters) {
  const std::filesystem::path path = sim::find_world(world);
  sim::SimOptions options;
  options.seed = seed;
  options.max_duration_s = duration_s;
  auto loaded = sim::load_what_is_seen(path, options, parameters.rectified_fov_deg);
  if (!loaded.ok()) return loaded.error();
  const auto simulation = std::make_shared<const sim::Simulation>(std::move(*loaded));
  SimulatedTeam team;
  team.world = simulation->name();
  for (std::size_t robot = 0; robot < simulation->robot_count(); ++robot) {
    team.sources.push_back(std::make_unique<SimulatedSource>(simulation, robot));
  }
  return team;
}

}  // namespace zenith::tools
