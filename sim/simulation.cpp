#include "sim/simulation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>

#include "drivers/odometry/agilex_v2.h"
#include "sim/camera.h"
#include "sim/renderer.h"
#include "sim/seed.h"
#include "sim/sensor.h"
#include "sim/world.h"

namespace zenith::sim {
namespace {

CameraMotion camera_motion(const Run& run, double time_s, double exposure_s) {
  const auto camera_at = [&](double t) {
    const Pose2 pose = run.path.at(t).pose;
    const Eigen::Vector2d p = pose * Eigen::Vector2d(run.truth.mount.x_m, run.truth.mount.y_m);
    return Pose2{p.x(), p.y(), pose.theta_rad};
  };
  const Pose2 middle = camera_at(time_s);
  const Pose2 begin = camera_at(time_s - 0.5 * exposure_s);
  const Pose2 end = camera_at(time_s + 0.5 * exposure_s);
  return {middle.x_m,
          middle.y_m,
          run.truth.mount.z_m,
          middle.theta_rad,
          end.x_m - begin.x_m,
          end.y_m - begin.y_m,
          end.theta_rad - begin.theta_rad};
}

}  // namespace

struct RobotDrive::State {
  State(const World& w, std::size_t index)
      : world(w),
        spec(w.file.robots[index]),
        run(w.runs[index]),
        robot(index),
        camera(run.truth, w.file.camera.field_deg, w.options.max_view_angle_deg),
        sensor(w.file.camera, spec.exposure_ev),
        renderer(w.plan, spec.lamps_on ? *w.lit : *w.dark, camera) {
    Random random = random_stream(w.seed, "wheels", index);
    bus = drive_wheels(run.path, run.duration_s, Time{kFirstStamp_ns}, w.file.wheels,
                       run.wheel_errors, random);
  }

  double exposure_s() const {
    return 1e-3 * (spec.exposure_ms > 0.0 ? spec.exposure_ms : world.file.camera.exposure_ms);
  }

  const World& world;
  const RobotSpec& spec;
  const Run& run;
  std::size_t robot;
  Camera camera;
  Sensor sensor;
  Renderer renderer;
  std::vector<CanFrame> bus;
  std::size_t next_can = 0;
  int next_frame = 0;
};

RobotDrive::RobotDrive(const World& world, std::size_t robot)
    : state_(std::make_unique<State>(world, robot)) {}
RobotDrive::~RobotDrive() = default;
RobotDrive::RobotDrive(RobotDrive&&) noexcept = default;
RobotDrive& RobotDrive::operator=(RobotDrive&&) noexcept = default;

const std::string& RobotDrive::name() const {
  return state_->spec.name;
}
const RobotConfig& RobotDrive::config() const {
  return state_->run.believed;
}
const RobotConfig& RobotDrive::truth() const {
  return state_->run.truth;
}

int RobotDrive::frame_count() const {
  return static_cast<int>(
             std::floor(state_->run.duration_s * state_->world.file.frame_rate_hz + 1e-6)) +
         1;
}

Pose2 RobotDrive::T_world_robot(Time stamp) const {
  Pose2 pose = state_->run.path.at((stamp - Time{kFirstStamp_ns}).seconds()).pose;
  pose.theta_rad = wrap_angle(pose.theta_rad);
  return pose;
}

bool RobotDrive::next(SimFrame& frame, std::vector<CanFrame>& can) {
  State& s = *state_;
  can.clear();
  if (s.next_frame >= frame_count()) return false;
  const double time_s = s.next_frame / s.world.file.frame_rate_hz;
  frame.stamp = Time{kFirstStamp_ns} + Duration::from_seconds(time_s);
  frame.T_world_robot = T_world_robot(frame.stamp);
  const auto& radiance = s.renderer.render(camera_motion(s.run, time_s, s.exposure_s()));
  Random noise = random_stream(mix_seed(s.world.seed, "noise", s.robot), "frame",
                               static_cast<std::uint64_t>(s.next_frame));
  s.sensor.develop(radiance, noise, frame.pixels);
  while (s.next_can < s.bus.size()) {
    const CanFrame& next = s.bus[s.next_can++];
    can.push_back(next);
    if (next.id == agilex_v2::kOdometerId && next.stamp >= frame.stamp) break;
  }
  ++s.next_frame;
  return true;
}

Simulation::Simulation(std::unique_ptr<const World> world) : world_(std::move(world)) {}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

Result<Simulation> Simulation::load(const std::filesystem::path& world_toml,
                                    const SimOptions& options) {
  auto file = load_world_file(world_toml);
  if (!file) return file.error();
  auto plan = FloorPlan::build(*file);
  if (!plan) return plan.error();
  auto world = std::make_unique<World>();
  world->file = std::move(*file);
  if (options.frame_rate_hz > 0.0) world->file.frame_rate_hz = options.frame_rate_hz;
  world->options = options;
  world->plan = std::move(*plan);
  world->seed = mix_seed(options.seed, "world", world->file.seed);
  bool any_lit = false;
  bool any_dark = false;
  for (std::size_t i = 0; i < world->file.robots.size(); ++i) {
    auto run = plan_run(world->file, world->plan, i, world->seed, options);
    if (!run) return run.error();
    world->runs.push_back(std::move(*run));
    (world->file.robots[i].lamps_on ? any_lit : any_dark) = true;
  }
  const auto scene = [&world](bool lamps_on) {
    return std::make_unique<const Scene>(world->file, world->plan, world->seed, lamps_on);
  };
  if (any_lit) world->lit = scene(true);
  if (any_dark) world->dark = scene(false);
  return Simulation(std::move(world));
}

const std::string& Simulation::name() const {
  return world_->file.name;
}
std::size_t Simulation::robot_count() const {
  return world_->file.robots.size();
}

RobotDrive Simulation::drive(std::size_t robot) const {
  assert(robot < robot_count());
  return RobotDrive(*world_, robot);
}

namespace {

std::filesystem::path worlds_folder() {
  const char* named = std::getenv("ZENITH_WORLDS");
  return named != nullptr ? std::filesystem::path(named) : ZENITH_WORLDS_DIR;
}

}  // namespace

std::filesystem::path find_world(const std::string& name_or_path) {
  const std::filesystem::path path(name_or_path);
  if (path.extension() == ".toml" || path.has_parent_path()) return path;
  return worlds_folder() / (name_or_path + ".toml");
}

std::vector<std::string> list_worlds() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(worlds_folder(), error)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace zenith::sim
