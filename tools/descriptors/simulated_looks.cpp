// Looks of a simulated world, by true poses and the building's geometry.

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "sim/simulation.h"
#include "sim/skyline.h"
#include "sim/world.h"
#include "slam/image/lens_projection.h"
#include "tools/descriptors/extractor.h"
#include "tools/descriptors/looks.h"

namespace zenith::tools {
namespace {

constexpr double kMinStep_m = 0.1;
constexpr double kMinTurn_rad = 5.0 * std::numbers::pi / 180.0;
constexpr double kSamePlace_px = 2.0;
constexpr float kMinSlope = 0.3F;  // below, no ray of the rectified image goes

// Where a corner's true ray ends.
struct Sighting {
  sim::FacetId facet = sim::kNoFacet;
  Eigen::Vector3d place_m = Eigen::Vector3d::Zero();
};

struct Place {
  sim::FacetId facet = sim::kNoFacet;
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  int count = 0;
  int last_frame = -1;
};

// A robot's camera in the true world: its calibration is a little wrong, as the robot's is.
class TrueCamera {
 public:
  TrueCamera(const RobotConfig& believed, const RobotConfig& truth, const sim::FloorPlan& plan)
      : believed_lens_(believed.lens),
        true_lens_(truth.lens),
        truth_(truth),
        R_believed_(mount_rotation(believed.mount)),
        R_truth_(mount_rotation(truth.mount)),
        plan_(plan) {}

  void move(const Pose2& T_world_robot) {
    heading_rad_ = T_world_robot.theta_rad;
    const Eigen::Vector2d at = T_world_robot * Eigen::Vector2d(truth_.mount.x_m, truth_.mount.y_m);
    eye_m_ = {at.x(), at.y(), truth_.mount.z_m};
    skyline_.look(plan_, at.x(), at.y(), truth_.mount.z_m, kMinSlope);
  }

  std::optional<Sighting> sight(const Feature& f) const {
    const Eigen::Vector3d seen(static_cast<double>(f.zx), static_cast<double>(f.zy), 1.0);
    const auto px = believed_lens_.project(R_believed_.transpose() * seen);
    const auto in_camera = px ? true_lens_.unproject(*px) : std::nullopt;
    if (!in_camera) return {};
    const Eigen::Vector3d ray =
        Eigen::AngleAxisd(heading_rad_, Eigen::Vector3d::UnitZ()) * (R_truth_ * *in_camera);
    const double slope = ray.z() / std::max(std::hypot(ray.x(), ray.y()), 1e-9);
    if (slope <= static_cast<double>(kMinSlope)) return {};
    const double turn = std::atan2(ray.y(), ray.x()) / (2.0 * std::numbers::pi);
    Sighting out;
    out.facet = skyline_.facet(static_cast<float>(turn < 0.0 ? turn + 1.0 : turn),
                               static_cast<float>(slope));
    if (out.facet == sim::kNoFacet) return {};
    const sim::Facet& facet = plan_.facets()[out.facet];
    const double way = (static_cast<double>(facet.offset) - eye_m_[facet.axis]) / ray[facet.axis];
    if (!std::isfinite(way) || way <= 0.0) return {};
    out.place_m = eye_m_ + way * ray;
    return out;
  }

  // Tangents in the level image, world axes.
  Eigen::Vector2d project(const Eigen::Vector3d& p_m) const {
    return (p_m - eye_m_).head<2>() / (p_m.z() - eye_m_.z());
  }

 private:
  LensProjection believed_lens_;
  LensProjection true_lens_;
  RobotConfig truth_;
  Eigen::Matrix3d R_believed_;
  Eigen::Matrix3d R_truth_;
  const sim::FloorPlan& plan_;
  sim::Skyline skyline_;
  Eigen::Vector3d eye_m_ = Eigen::Vector3d::Zero();
  double heading_rad_ = 0.0;
};

// The landmark of a sighting: the nearest place on the same surface within `radius` tangents that
// this frame has not shown yet, or a new one.
int find_place(std::vector<Place>& places, const Sighting& s, const TrueCamera& camera,
               double radius, int frame) {
  const Eigen::Vector2d at = camera.project(s.place_m);
  int best = -1;
  double best_distance = radius;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Place& p = places[i];
    if (p.facet != s.facet || p.last_frame == frame) continue;
    if ((p.mean_m - s.place_m).squaredNorm() > 1.0) continue;
    const double distance = (camera.project(p.mean_m) - at).norm();
    if (distance >= best_distance) continue;
    best_distance = distance;
    best = static_cast<int>(i);
  }
  if (best < 0) {
    best = static_cast<int>(places.size());
    places.push_back({s.facet, s.place_m, 0, frame});
  }
  Place& place = places[static_cast<std::size_t>(best)];
  ++place.count;
  place.mean_m += (s.place_m - place.mean_m) / place.count;
  place.last_frame = frame;
  return best;
}

void drive_and_look(const sim::Simulation& simulation, std::size_t robot, bool ceilings,
                    LookSequence& out, std::vector<Place>& places, int& frame_number) {
  sim::RobotDrive drive = simulation.drive(robot);
  const sim::FloorPlan& plan = simulation.world().plan;
  TrueCamera camera(drive.config(), drive.truth(), plan);
  OwnExtractor extractor(drive.config(), Parameters{});
  const double radius = kSamePlace_px / extractor->pinhole().focal_px;
  const Lens& lens = drive.config().lens;
  sim::SimFrame frame;
  std::vector<CanFrame> can;
  std::optional<Pose2> last;
  while (drive.next(frame, can)) {
    const Pose2& pose = frame.T_world_robot;
    if (last && (pose.position() - last->position()).norm() < kMinStep_m &&
        std::abs(wrap_angle(pose.theta_rad - last->theta_rad)) < kMinTurn_rad) {
      continue;
    }
    last = pose;
    ++frame_number;
    camera.move(pose);
    const ImageView image = {frame.pixels.data(), lens.width_px, lens.height_px, lens.width_px};
    for (const Feature& f : extractor->extract(image)) {
      if (!f.described) continue;
      const std::optional<Sighting> sighting = camera.sight(f);
      if (!sighting) continue;
      if (ceilings && plan.facets()[sighting->facet].axis != 2) continue;
      Look look;
      look.landmark = find_place(places, *sighting, camera, radius, frame_number);
      look.robot = static_cast<int>(robot);
      look.frame = frame_number;
      look.T_world_robot = pose;
      look.direction_rad =
          static_cast<float>(wrap_angle(pose.theta_rad + static_cast<double>(f.orientation_rad)));
      look.patch = f.patch;
      out.looks.push_back(look);
    }
  }
}

}  // namespace

Result<LookSequence> simulated_looks(const std::string& world, std::uint64_t seed,
                                     double duration_s, bool ceilings) {
  sim::SimOptions options;
  options.seed = seed;
  options.max_duration_s = duration_s;
  options.max_view_angle_deg = 75.0;
  const auto simulation = sim::Simulation::load(sim::find_world(world), options);
  if (!simulation.ok()) return simulation.error();
  LookSequence out;
  out.name = simulation->name() + (ceilings ? " (ceilings)" : "");
  out.robots = static_cast<int>(simulation->robot_count());
  std::vector<Place> places;
  int frame_number = 0;
  for (std::size_t robot = 0; robot < simulation->robot_count(); ++robot) {
    drive_and_look(*simulation, robot, ceilings, out, places, frame_number);
  }
  for (const Place& place : places) out.places_m.push_back(place.mean_m);
  return out;
}

}  // namespace zenith::tools
