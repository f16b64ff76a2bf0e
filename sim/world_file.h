#pragma once
// A world as its file describes it: rooms, doors, hanging boxes, camera, wheels, robots. Plain
// data; metres, degrees as the names say; world frame x east, y north, z up, floor at z = 0.
// The worlds/ folder shows the format; every key is listed in world_file.cpp.

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "platform/base/result.h"
#include "slam/robot.h"

namespace zenith::sim {

struct Rect {
  double x0 = 0.0;
  double y0 = 0.0;
  double x1 = 0.0;
  double y1 = 0.0;

  bool contains(double x, double y) const { return x >= x0 && x <= x1 && y >= y0 && y <= y1; }
  double width() const { return x1 - x0; }
  double depth() const { return y1 - y0; }
};

// tiles: suspended, 0.6 m grid, speckled. plaster: smooth, cracks, repairs. concrete: mottled,
// formwork joints. periodic: tiles and lamps that repeat exactly. blank: almost nothing.
enum class CeilingStyle { kTiles, kPlaster, kConcrete, kPeriodic, kBlank };
enum class LampStyle { kPanels, kTubes, kRound, kNone };
enum class WallStyle { kOffice, kPeriodic, kBlank };
enum class BoxKind { kBeam, kDuct, kPipe, kTray };

// The inner faces of the walls. Where no room or door is, there is solid wall.
struct RoomSpec {
  std::string name;
  Rect rect;
  double ceiling_m = 2.6;
  CeilingStyle ceiling = CeilingStyle::kTiles;
  LampStyle lamps = LampStyle::kPanels;
  WallStyle walls = WallStyle::kOffice;
  double clutter = 1.0;  // how many vents, detectors, stains, posters: 1 is an ordinary office
  unsigned line = 0;     // in the file
};

// An opening through a wall, between two rooms: its rectangle fills the wall's thickness.
struct DoorSpec {
  Rect rect;
  double height_m = 2.1;
  unsigned line = 0;
};

// Hangs under the ceiling of the room that contains it, and reaches up to it.
struct BoxSpec {
  Rect rect;
  double drop_m = 0.3;
  BoxKind kind = BoxKind::kBeam;
  unsigned line = 0;
};

struct CameraSpec {
  Lens lens;
  CameraMount mount;
  double field_deg = 190.0;  // the lens's image circle; black outside
  double exposure_ms = 8.0;
  double full_well_e = 12000.0;  // electrons at pixel value 255
  double read_noise_e = 15.0;
  double blur_px = 0.5;  // standard deviation of the lens's point spread
};

// Standard deviations of what the calibration gets wrong; drawn once per robot and seed.
struct CalibrationError {
  double principal_px = 0.1;
  double focal_relative = 0.001;
  double tilt_deg = 0.05;
  double yaw_deg = 0.05;
  double lever_m = 0.002;
};

struct WheelSpec {
  double track_width_m = 0.40;
  // The scale of both wheels together is the metre itself: ceiling vision of one camera cannot see
  // it, so it is what a straight drive along a tape leaves (UMBmark reaches 0.1 to 0.3 %). Unequal
  // wheels are what bends odometry. Both constant for a run.
  double scale_sigma = 0.0015;
  double unequal_sigma = 0.01;  // of the difference of the two wheels
  double track_sigma = 0.01;    // relative
  double slip_sigma_per_sqrt_m = 0.003;
  double drift_sigma = 0.002;       // of the scale, slow: time constant 20 s
  double slip_events_per_m = 0.01;  // a wheel turns 1 to 4 cm too far
  double latency_ms = 0.0;          // the base's frames come so much late
};

struct RobotSpec {
  std::string name;
  std::vector<Eigen::Vector2d> path;  // way-points
  double speed_mps = 0.5;
  double jitter_m = 0.08;  // way-points move by up to this much in x and y, per seed
  double start_heading_deg = 0.0;
  bool has_start_heading = false;  // otherwise towards the second way-point
  double exposure_ev = 0.0;
  double exposure_ms = 0.0;  // 0: the camera's
  bool lamps_on = true;
  double start_delay_s = 0.0;  // stands still this long first
  unsigned line = 0;
};

struct WorldFile {
  std::string name;
  std::uint64_t seed = 0;
  double frame_rate_hz = 10.0;
  std::vector<RoomSpec> rooms;
  std::vector<DoorSpec> doors;
  std::vector<BoxSpec> boxes;
  CameraSpec camera;
  CalibrationError calibration_error;
  WheelSpec wheels;
  std::vector<RobotSpec> robots;
};

// All errors at once, each with file and line. Unknown keys are errors.
Result<WorldFile> load_world_file(const std::filesystem::path& path);

}  // namespace zenith::sim
