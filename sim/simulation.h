#pragma once
// Robots that drive through a made-up building: fisheye frames, CAN odometry and the truth.
//
// Everything follows from the world file and the seed: the building's looks, the paths' small
// deviations, the wheels' errors, the calibration's errors and the noise. The same seed gives the
// same bytes on the same build. All robots of a world share one clock, which starts at 1 s.
//
// A frame's stamp is the middle of its exposure. T_world_robot is the pose of base_link.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "drivers/odometry/can_frame.h"
#include "platform/base/result.h"
#include "platform/base/time.h"
#include "slam/geometry.h"
#include "slam/robot.h"

namespace zenith::sim {

struct SimOptions {
  std::uint64_t seed = 1;
  double max_duration_s = 0.0;  // 0: the whole run
  // Only pixels whose ray lies within this angle of the optical axis are rendered; the others are
  // black. 180: the whole image.
  double max_view_angle_deg = 180.0;
  double frame_rate_hz = 0.0;  // 0: the world file's
};

struct SimFrame {
  Time stamp;
  std::vector<std::uint8_t> pixels;  // rows of lens.width_px, lens.height_px of them
  Pose2 T_world_robot;
};

struct World;

// One robot's run, frames in order. Independent of other drives, also of those of the same robot.
class RobotDrive {
 public:
  RobotDrive(const World& world, std::size_t robot);
  ~RobotDrive();
  RobotDrive(RobotDrive&&) noexcept;
  RobotDrive& operator=(RobotDrive&&) noexcept;

  const std::string& name() const;
  const RobotConfig& config() const;  // what the robot believes: the calibration
  const RobotConfig& truth() const;   // what the simulator renders and drives with
  int frame_count() const;
  // Clamped to the run's first and last pose.
  Pose2 T_world_robot(Time stamp) const;

  // The next frame, and all CAN frames since the last call up to and including the first odometer
  // frame at or after frame.stamp. `frame.pixels` is reused. False at the end.
  bool next(SimFrame& frame, std::vector<CanFrame>& can);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

class Simulation {
 public:
  static Result<Simulation> load(const std::filesystem::path& world_toml,
                                 const SimOptions& options);
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  const std::string& name() const;
  std::size_t robot_count() const;
  // The Simulation must outlive it, but may be moved meanwhile. Safe to call from several threads.
  RobotDrive drive(std::size_t robot) const;
  const World& world() const { return *world_; }

 private:
  explicit Simulation(std::unique_ptr<const World> world);
  std::unique_ptr<const World> world_;
};

// "corridor-rooms" -> the folder of worlds / corridor-rooms.toml; a path to a file stays as it is.
// The folder is the environment variable ZENITH_WORLDS, or the one known at build time.
std::filesystem::path find_world(const std::string& name_or_path);
// Names of the folder's worlds, sorted.
std::vector<std::string> list_worlds();

}  // namespace zenith::sim
