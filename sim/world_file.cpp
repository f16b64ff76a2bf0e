#include "sim/world_file.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "platform/base/printable.h"
#include "platform/config/lens_settings.h"
#include "sim/toml_reader.h"

namespace zenith::sim {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// What a world may take of the memory: its ceilings are painted before the first frame.
constexpr double kFarthest_m = 1000.0;
constexpr double kMostFloor_m2 = 5000.0;
constexpr std::size_t kMostParts = 500;  // rooms, doors, boxes
constexpr std::size_t kMostRobots = 64;
constexpr std::size_t kMostPoints = 1000;  // of a robot's way

constexpr std::pair<std::string_view, CeilingStyle> kCeilingNames[] = {
    {"tiles", CeilingStyle::kTiles},
    {"plaster", CeilingStyle::kPlaster},
    {"concrete", CeilingStyle::kConcrete},
    {"periodic", CeilingStyle::kPeriodic},
    {"blank", CeilingStyle::kBlank}};
constexpr std::pair<std::string_view, LampStyle> kLampNames[] = {{"panels", LampStyle::kPanels},
                                                                 {"tubes", LampStyle::kTubes},
                                                                 {"round", LampStyle::kRound},
                                                                 {"none", LampStyle::kNone}};
constexpr std::pair<std::string_view, WallStyle> kWallNames[] = {{"office", WallStyle::kOffice},
                                                                 {"periodic", WallStyle::kPeriodic},
                                                                 {"blank", WallStyle::kBlank}};
constexpr std::pair<std::string_view, BoxKind> kBoxNames[] = {{"beam", BoxKind::kBeam},
                                                              {"duct", BoxKind::kDuct},
                                                              {"pipe", BoxKind::kPipe},
                                                              {"tray", BoxKind::kTray}};

void read_rect(TomlReader& in, Rect& rect) {
  double v[4] = {};
  if (!in.numbers("rect", v, 4, true)) return;
  if (v[2] <= v[0] || v[3] <= v[1]) {
    in.fail("rect", "expected [x0, y0, x1, y1] with x1 > x0 and y1 > y0");
    return;
  }
  if (std::any_of(v, v + 4, [](double at) { return std::abs(at) > kFarthest_m; })) {
    in.fail("rect", "expected coordinates within 1000 m");
    return;
  }
  rect = {v[0], v[1], v[2], v[3]};
}

RoomSpec read_room(const toml::table& table, TomlErrors& errors) {
  TomlReader in(table, errors);
  RoomSpec room;
  in.text("name", room.name, true);
  read_rect(in, room.rect);
  in.number("ceiling_m", room.ceiling_m, 2.0, 30.0);
  in.choice("ceiling", room.ceiling, kCeilingNames);
  in.choice("lamps", room.lamps, kLampNames);
  in.choice("walls", room.walls, kWallNames);
  in.number("clutter", room.clutter, 0.0, 4.0);
  room.line = table.source().begin.line;
  in.finish();
  return room;
}

DoorSpec read_door(const toml::table& table, TomlErrors& errors) {
  TomlReader in(table, errors);
  DoorSpec door;
  read_rect(in, door.rect);
  in.number("height_m", door.height_m, 1.8, 8.0);
  door.line = table.source().begin.line;
  in.finish();
  return door;
}

BoxSpec read_box(const toml::table& table, TomlErrors& errors) {
  TomlReader in(table, errors);
  BoxSpec box;
  read_rect(in, box.rect);
  in.number("drop_m", box.drop_m, 0.02, 2.0);
  in.choice("kind", box.kind, kBoxNames);
  box.line = table.source().begin.line;
  in.finish();
  return box;
}

// `distortion` are the model's numbers in the order of the table in slam/image/lens.h.
void read_lens(TomlReader& in, Lens& lens) {
  std::string model(lens_model_name(lens.model));
  in.text("model", model);
  const auto found = find_lens_model(model);
  if (!found) {
    std::string known;
    for (const std::string& name : lens_model_names()) {
      known += (known.empty() ? "" : ", ") + name;
    }
    return in.fail("model", "expected one of " + known + ", found \"" + model + "\"");
  }
  if (*found != lens.model) {
    lens = {};
    lens.model = *found;
  }
  double size[2] = {static_cast<double>(lens.width_px), static_cast<double>(lens.height_px)};
  in.numbers("size_px", size, 2, false);
  lens.width_px = static_cast<int>(std::clamp(size[0], 0.0, 1e4));
  lens.height_px = static_cast<int>(std::clamp(size[1], 0.0, 1e4));
  double intrinsics[4] = {lens.fu_px, lens.fv_px, lens.cu_px, lens.cv_px};
  in.numbers("intrinsics_px", intrinsics, 4, false);
  lens.fu_px = intrinsics[0];
  lens.fv_px = intrinsics[1];
  lens.cu_px = intrinsics[2];
  lens.cv_px = intrinsics[3];
  const auto numbers = lens_numbers(lens.model);
  std::vector<double> values;
  for (const LensNumber& number : numbers) values.push_back(number.of(lens));
  in.numbers("distortion", values.data(), values.size(), false);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i].at(lens) = values[i];
  if (lens.model == LensModel::kScaramuzza) {
    in.coefficients("polynomial", lens.polynomial);
    in.coefficients("inverse_polynomial", lens.inverse_polynomial);
  }
  if (const Status good = check_lens(lens); !good) in.fail("model", good.error().message);
}

void read_camera(const toml::table& table, TomlErrors& errors, CameraSpec& camera) {
  TomlReader in(table, errors);
  read_lens(in, camera.lens);
  double xyz[3] = {camera.mount.x_m, camera.mount.y_m, camera.mount.z_m};
  in.numbers("mount_m", xyz, 3, false);
  camera.mount.x_m = xyz[0];
  camera.mount.y_m = xyz[1];
  camera.mount.z_m = xyz[2];
  double rpy[3] = {camera.mount.roll_rad / kRadPerDeg, camera.mount.pitch_rad / kRadPerDeg,
                   camera.mount.yaw_rad / kRadPerDeg};
  in.numbers("roll_pitch_yaw_deg", rpy, 3, false);
  camera.mount.roll_rad = rpy[0] * kRadPerDeg;
  camera.mount.pitch_rad = rpy[1] * kRadPerDeg;
  camera.mount.yaw_rad = rpy[2] * kRadPerDeg;
  in.number("field_deg", camera.field_deg, 60.0, 220.0);
  in.number("exposure_ms", camera.exposure_ms, 0.0, 60.0);
  in.number("full_well_e", camera.full_well_e, 500.0, 1e6);
  in.number("read_noise_e", camera.read_noise_e, 0.0, 1000.0);
  in.number("blur_px", camera.blur_px, 0.0, 0.7);
  in.finish();
}

void read_calibration(const toml::table& table, TomlErrors& errors, CalibrationError& error) {
  TomlReader in(table, errors);
  in.number("principal_px", error.principal_px, 0.0, 10.0);
  in.number("focal_relative", error.focal_relative, 0.0, 0.1);
  in.number("tilt_deg", error.tilt_deg, 0.0, 5.0);
  in.number("yaw_deg", error.yaw_deg, 0.0, 5.0);
  in.number("lever_m", error.lever_m, 0.0, 0.1);
  in.finish();
}

void read_wheels(const toml::table& table, TomlErrors& errors, WheelSpec& wheels) {
  TomlReader in(table, errors);
  in.number("track_width_m", wheels.track_width_m, 0.1, 2.0);
  in.number("scale_sigma", wheels.scale_sigma, 0.0, 0.1);
  in.number("unequal_sigma", wheels.unequal_sigma, 0.0, 0.1);
  in.number("track_sigma", wheels.track_sigma, 0.0, 0.1);
  in.number("slip_sigma_per_sqrt_m", wheels.slip_sigma_per_sqrt_m, 0.0, 0.1);
  in.number("drift_sigma", wheels.drift_sigma, 0.0, 0.1);
  in.number("slip_events_per_m", wheels.slip_events_per_m, 0.0, 1.0);
  in.number("latency_ms", wheels.latency_ms, 0.0, 200.0);
  in.finish();
}

// Its recording is a folder of that name.
bool names_a_folder(const std::string& name) {
  return is_robot_name(name) && name.find('/') == std::string::npos && name != "." && name != "..";
}

RobotSpec read_robot(const toml::table& table, TomlErrors& errors) {
  TomlReader in(table, errors);
  RobotSpec robot;
  in.text("name", robot.name, true);
  if (in.has("name") && !names_a_folder(robot.name)) {
    in.fail("name", "expected 1 to 32 bytes of printable UTF-8 that can name a folder");
  }
  std::vector<std::pair<double, double>> points;
  in.points("path", points);
  for (const auto& [x, y] : points) robot.path.emplace_back(x, y);
  if (points.size() > kMostPoints) in.fail("path", "expected at most 1000 points");
  in.number("speed_mps", robot.speed_mps, 0.05, 2.0);
  in.number("jitter_m", robot.jitter_m, 0.0, 1.0);
  robot.has_start_heading = in.has("start_heading_deg");
  in.number("start_heading_deg", robot.start_heading_deg, -360.0, 360.0);
  in.number("exposure_ev", robot.exposure_ev, -6.0, 6.0);
  in.number("exposure_ms", robot.exposure_ms, 0.0, 60.0);
  in.boolean("lamps_on", robot.lamps_on);
  in.number("start_delay_s", robot.start_delay_s, 0.0, 600.0);
  robot.line = table.source().begin.line;
  in.finish();
  return robot;
}

WorldFile read_world(const toml::table& table, TomlErrors& errors) {
  TomlReader in(table, errors);
  WorldFile world;
  double seed = 0.0;
  in.number("seed", seed, 0.0, 1e9);
  world.seed = static_cast<std::uint64_t>(seed);
  in.number("frame_rate_hz", world.frame_rate_hz, 1.0, 60.0);
  for (const auto* room : in.tables("room")) world.rooms.push_back(read_room(*room, errors));
  for (const auto* door : in.tables("door")) world.doors.push_back(read_door(*door, errors));
  for (const auto* box : in.tables("box")) world.boxes.push_back(read_box(*box, errors));
  // A lens whose image circle is a little larger than the image is high, as small fisheyes have.
  world.camera.lens.k = {-0.012, 0.004, -0.0015, 0.0001};
  if (const auto* camera = in.table("camera")) read_camera(*camera, errors, world.camera);
  if (const auto* error = in.table("calibration_error")) {
    read_calibration(*error, errors, world.calibration_error);
  }
  if (const auto* wheels = in.table("wheels")) read_wheels(*wheels, errors, world.wheels);
  for (const auto* robot : in.tables("robot")) world.robots.push_back(read_robot(*robot, errors));
  if (world.rooms.empty()) in.fail("room", "expected at least one [[room]]");
  double floor_m2 = 0.0;
  for (const RoomSpec& room : world.rooms) {
    floor_m2 += (room.rect.x1 - room.rect.x0) * (room.rect.y1 - room.rect.y0);
  }
  if (floor_m2 > kMostFloor_m2) in.fail("room", "expected rooms of 5000 m2 at most, in all");
  if (std::max({world.rooms.size(), world.doors.size(), world.boxes.size()}) > kMostParts) {
    in.fail("room", "expected at most 500 rooms, 500 doors and 500 boxes");
  }
  if (world.robots.size() > kMostRobots) in.fail("robot", "expected at most 64 robots");
  if (world.robots.empty()) in.fail("robot", "expected at least one [[robot]]");
  in.finish();
  return world;
}

}  // namespace

Result<WorldFile> load_world_file(const std::filesystem::path& path) {
  const auto text = read_toml(path);
  if (!text) return text.error();
  const toml::parse_result parsed = parse_toml(*text);
  if (!parsed) return toml_error(path, parsed.error());
  TomlErrors errors(path.string());
  WorldFile world = read_world(parsed.table(), errors);
  if (!errors.empty()) return Error{errors.text()};
  world.name = path.stem().string();
  return world;
}

}  // namespace zenith::sim
