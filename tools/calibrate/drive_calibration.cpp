#include "tools/calibrate/drive_calibration.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "platform/recording/sensor_file.h"
#include "slam/image/lens_projection.h"
#include "slam/image/rectify.h"
#include "tools/doctor/formatted.h"

namespace zenith::tools {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
// What the least squares do not know: wheels whose scale changes slowly while they roll.
constexpr double kWheelDrift = 0.001;
// A lens's centre that is off by so much looks like a camera that leans.
constexpr double kCentre_px = 0.1;
// Errors of the latency beside chance, as simulated drives show them.
constexpr double kLatency_s = 0.003;
constexpr double kTape_m = 0.005;
// Where a camera can be on a robot, in widths of its tracks: ahead or behind, and to the sides.
constexpr double kReachAhead = 1.5;
constexpr double kReachAside = 0.75;
constexpr const char* kSpin = "turn on the spot more, a whole turn to each side";
constexpr const char* kStraight = "drive straight more, some metres at a time";
constexpr const char* kBoth = "turn on the spot and drive straight, in turn";
constexpr const char* kJerk = "begin and end turns quickly, ten times or more";

CameraMount mount_of(const DriveUnknowns& u, double z_m) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = u.R_base_camera;
  T.topRightCorner<3, 1>() << u.lever_m, z_m;
  return mount_of_matrix(T);
}

// Standard deviations of roll, pitch, yaw in degrees.
Eigen::Vector3d angle_sigmas(const DriveSolution& s) {
  constexpr double kStep = 1e-6;
  const CameraMount at = mount_of(s.unknowns, 0.0);
  Eigen::Matrix3d by_turn;
  for (int i = 0; i < 3; ++i) {
    DriveVector step = DriveVector::Zero();
    step(i) = kStep;
    const CameraMount m = mount_of(s.unknowns.moved(step), 0.0);
    by_turn.col(i) << (m.roll_rad - at.roll_rad) / kStep, (m.pitch_rad - at.pitch_rad) / kStep,
        wrap_angle(m.yaw_rad - at.yaw_rad) / kStep;
  }
  const Eigen::Matrix3d covariance =
      by_turn * s.covariance.topLeftCorner<3, 3>() * by_turn.transpose();
  return covariance.diagonal().cwiseSqrt() * kDegPerRad;
}

// All lengths in the same measure: one camera leaves it open.
void rescale(DriveSolution& s, double factor) {
  s.unknowns.scale *= factor;
  s.unknowns.track_width_m *= factor;
  s.unknowns.lever_m *= factor;
  for (Pose2& pose : s.poses) {
    pose.x_m *= factor;
    pose.y_m *= factor;
  }
  for (double& height : s.heights_m) height *= factor;
  DriveVector lengths = DriveVector::Ones();
  lengths(3) = lengths(4) = lengths(6) = factor;
  s.covariance = lengths.asDiagonal() * s.covariance * lengths.asDiagonal();
}

// The height near which most points lie; none when they lie everywhere.
std::optional<double> most_common(std::vector<double> heights) {
  constexpr double kWidth = 1.03;
  std::sort(heights.begin(), heights.end());
  std::size_t best = 0;
  std::size_t best_begin = 0;
  std::size_t end = 0;
  for (std::size_t begin = 0; begin < heights.size(); ++begin) {
    while (end < heights.size() && heights[end] <= kWidth * heights[begin]) ++end;
    if (end - begin <= best) continue;
    best = end - begin;
    best_begin = begin;
  }
  if (best < 10 || best < heights.size() / 6) return std::nullopt;
  return heights[best_begin + best / 2];
}

// Sigma of the measure, relative; 0 without a reference.
double apply_references(const DriveReferences& references, double camera_m, DriveCalibration& c) {
  DriveSolution& s = c.solution;
  double sigma = 0.0;
  if (references.distance_m) {
    const double seen = (s.poses.back().position() - s.poses.front().position()).norm();
    if (seen < 1.0) {
      c.judgement.lower(Worth::kUsable,
                        formatted("--distance: the drive ends %.2f m from where it began, expected "
                                  "1 m or more: the scale of the wheels stays as it was",
                                  seen));
    } else {
      rescale(s, *references.distance_m / seen);
      c.scale_known = true;
      sigma = kTape_m / *references.distance_m;
    }
  }
  c.ceiling_m = most_common(s.heights_m);
  if (!references.ceiling_m || c.scale_known) return sigma;
  if (!c.ceiling_m) {
    c.judgement.lower(Worth::kUsable,
                      "--ceiling: the points seen lie at no common height: the "
                      "scale of the wheels stays as it was");
    return sigma;
  }
  const double above = *references.ceiling_m - camera_m;
  rescale(s, above / *c.ceiling_m);
  c.ceiling_m = above;
  c.scale_known = true;
  return 2.0 * kTape_m / above;
}

void measure_way(const DriveData& data, DriveCalibration& c) {
  const Wheels wheels = c.solution.unknowns.wheels();
  for (std::size_t i = 1; i < data.frames.size(); ++i) {
    const Pose2 moved =
        wheel_motion(wheels, data.travel(data.frames[i - 1].time_s, data.frames[i].time_s,
                                         c.solution.unknowns.latency_s));
    c.driven_m += moved.position().norm();
    c.turned_deg += std::abs(moved.theta_rad) * kDegPerRad;
  }
}

void list_estimates(const DriveData& data, double scale_sigma, DriveCalibration& c) {
  const DriveSolution& s = c.solution;
  const CameraMount& was = data.believed.mount;
  const CameraMount now = mount_of(s.unknowns, was.z_m);
  const Wheels& old = data.believed.wheels;
  const Wheels wheels = s.unknowns.wheels();
  const Eigen::Vector3d angle = angle_sigmas(s);
  const auto sigma = [&s](int i) { return std::sqrt(s.covariance(i, i)); };
  const double ratio = std::hypot(sigma(5), kWheelDrift);
  const double track = std::hypot(sigma(6), kWheelDrift * wheels.track_width_m);
  const Lens& lens = data.believed.lens;
  const double focal_px = lens.fu_px * LensProjection(lens).axis_slope();
  const double lean_deg = kCentre_px / focal_px * kDegPerRad;
  const double by_scale = scale_sigma * wheels.track_width_m;
  c.estimates = {
      {"mount.roll_deg", "deg", was.roll_rad * kDegPerRad, now.roll_rad * kDegPerRad,
       std::hypot(angle(0), lean_deg), 0.05, 0.2, kSpin},
      {"mount.pitch_deg", "deg", was.pitch_rad * kDegPerRad, now.pitch_rad * kDegPerRad,
       std::hypot(angle(1), lean_deg), 0.05, 0.2, kSpin},
      {"mount.yaw_deg", "deg", was.yaw_rad * kDegPerRad, now.yaw_rad * kDegPerRad, angle(2), 0.1,
       0.4, kStraight},
      {"mount.x_m", "m", was.x_m, now.x_m, sigma(3), 0.005, 0.015, kSpin},
      {"mount.y_m", "m", was.y_m, now.y_m, sigma(4), 0.005, 0.015, kSpin},
      {"wheels.track_width_m", "m", old.track_width_m, wheels.track_width_m,
       std::hypot(track, by_scale), 0.003 * wheels.track_width_m, 0.01 * wheels.track_width_m,
       kSpin},
      {"wheels.left_scale", "", old.left_scale, wheels.left_scale,
       std::hypot(0.5 * ratio, scale_sigma), 0.004, 0.01, kBoth},
      {"wheels.right_scale", "", old.right_scale, wheels.right_scale,
       std::hypot(0.5 * ratio, scale_sigma), 0.004, 0.01, kBoth},
      {"odometry.latency_s", "s", 0.0, c.setup.delay_s + s.unknowns.latency_s,
       std::hypot(sigma(7), kLatency_s), 0.005, 0.02, kJerk},
  };
}

// A lever arm beyond the robot is none: the turns were too few, or too far from the spot.
void doubt_lever_arm(double track_width_m, DriveCalibration& c) {
  const std::pair<const char*, double> reaches[] = {{"mount.x_m", kReachAhead * track_width_m},
                                                    {"mount.y_m", kReachAside * track_width_m}};
  for (DriveEstimate& e : c.estimates) {
    for (const auto& [key, reach_m] : reaches) {
      if (e.key != key || std::abs(e.value) - 2.0 * e.sigma <= reach_m) continue;
      e.doubt = formatted(
          "%.2f m is outside of a robot whose tracks are %.2f m apart, expected "
          "within %.2f m",
          e.value, track_width_m, reach_m);
    }
  }
}

void take_shown(const DriveReferences& references, DriveCalibration& c) {
  RobotConfig& r = c.robot;
  const CameraMount now = mount_of(c.solution.unknowns, r.mount.z_m);
  double* const values[] = {&r.mount.roll_rad,    &r.mount.pitch_rad,    &r.mount.yaw_rad,
                            &r.mount.x_m,         &r.mount.y_m,          &r.wheels.track_width_m,
                            &r.wheels.left_scale, &r.wheels.right_scale, &c.latency_s};
  const double found[] = {now.roll_rad, now.pitch_rad, now.yaw_rad, now.x_m, now.y_m};
  for (std::size_t i = 0; i < c.estimates.size(); ++i) {
    if (c.estimates[i].shown()) *values[i] = i < 5 ? found[i] : c.estimates[i].value;
  }
  constexpr std::size_t kYaw = 2;
  if (!c.estimates[kYaw].shown()) {
    r.mount.yaw_rad = wrap_angle(r.mount.yaw_rad + c.setup.change.yaw_rad);
  }
  if (references.distance_m && references.ceiling_m && c.scale_known && c.ceiling_m) {
    r.mount.z_m = *references.ceiling_m - *c.ceiling_m;
  }
}

void judge_data(DriveCalibration& c) {
  Judgement& j = c.judgement;
  const DriveSolution& s = c.solution;
  for (const std::string& line : setup_text(c.setup)) {
    j.lower(c.setup.contradicts() ? Worth::kAgain : Worth::kUsable, line);
  }
  if (s.points < 60) {
    j.lower(Worth::kAgain, formatted("only %d points of the ceiling were followed, expected 60 or "
                                     "more: light it, or lower corner_min_eigenvalue",
                                     s.points));
  }
  if (s.sight_sigma_rad > 0.01) {
    j.lower(Worth::kAgain, formatted("the points seen disagree by %.2f degrees, expected below "
                                     "0.6: calibrate the lens first",
                                     s.sight_sigma_rad * kDegPerRad));
  }
  if (s.odometry_sigma > 4.0) {
    j.lower(s.odometry_sigma > 10.0 ? Worth::kAgain : Worth::kUsable,
            formatted("the wheels are %.0f times as noisy as those of a good base: they slip, or "
                      "are wired the wrong way round (swap_wheels, invert_left, invert_right)",
                      s.odometry_sigma));
  }
  if (std::abs(s.unknowns.ratio) > 0.3 || s.unknowns.track_width_m < 0.02) {
    j.lower(Worth::kAgain,
            "the wheels found are none: swap_wheels, invert_left or invert_right of "
            "[odometry] are wrong");
  }
}

void judge_estimates(DriveCalibration& c) {
  for (const DriveEstimate& e : c.estimates) {
    if (!e.doubt.empty()) {
      c.judgement.lower(Worth::kUsable,
                        e.key + " is doubtful: " + e.doubt + "; it stays as it was: " + e.advice);
    } else if (!e.shown()) {
      c.judgement.lower(Worth::kUsable,
                        e.key +
                            formatted(" is doubtful, +- %.3g %s where %.3g is expected: ", e.sigma,
                                      e.unit.c_str(), e.usable) +
                            "this drive does not show " + e.key +
                            ", which stays as it was: " + e.advice);
    } else if (e.sigma > e.good) {
      c.judgement.lower(Worth::kUsable, e.key + " could be known better: " + e.advice);
    }
  }
  if (!c.scale_known) {
    c.judgement.lower(Worth::kUsable,
                      "one camera does not see how long a metre is: the mean of both wheels' "
                      "scales stays as it was, and all lengths with it; measure the way from the "
                      "first to the last place and say --distance, or --ceiling");
  }
}

}  // namespace

DriveCalibration calibrate_drive(const DriveData& recorded, const DriveReferences& references) {
  DriveCalibration c;
  c.setup = find_setup(recorded);
  const DriveData data = mended(recorded, c.setup);
  c.robot = data.believed;
  c.latency_s = c.setup.delay_s;
  c.images = data.images;
  c.solution = solve_drive(data, start_of_drive(data));
  // Again from there: points that began badly get a new start.
  c.solution = solve_drive(data, c.solution.unknowns);
  measure_way(data, c);
  const double scale_sigma = apply_references(references, data.believed.mount.z_m, c);
  list_estimates(data, scale_sigma, c);
  doubt_lever_arm(c.solution.unknowns.track_width_m, c);
  judge_data(c);
  judge_estimates(c);
  take_shown(references, c);
  return c;
}

std::string drive_report(const DriveCalibration& c) {
  std::string text = formatted(
      "%.1f m driven and %.0f degrees turned, in %d images of which %zu "
      "were used; %d points of the ceiling seen %d times\n",
      c.driven_m, c.turned_deg, c.images, c.solution.poses.size(), c.solution.points,
      c.solution.sightings);
  text += formatted("points are off by %.3f degrees; wheels %.1f times as noisy as assumed\n",
                    c.solution.sight_sigma_rad * kDegPerRad, c.solution.odometry_sigma);
  text += formatted("%-22s %10s %10s    %s\n", "", "before", "found", "standard deviation");
  for (const DriveEstimate& e : c.estimates) {
    text += formatted("%-22s %10.4f %10.4f +- %.4f %s%s\n", e.key.c_str(), e.before, e.value,
                      e.sigma, e.unit.c_str(), e.shown() ? "" : "   doubtful: stays as it was");
  }
  if (c.ceiling_m) {
    text += formatted("most of the ceiling is %.3f m above the camera\n", *c.ceiling_m);
  }
  return text + judgement_text(c.judgement);
}

}  // namespace zenith::tools
