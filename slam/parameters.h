#pragma once
// The algorithm's parameters: one struct, and one table with each parameter's key, unit, range and
// text, from which parsing (`--set key=value`, TOML), checks and the reference page come.

#include <span>
#include <string_view>
#include <variant>

namespace zenith {

// A field of view that is fitted to the robot's lens (slam/image/view.h).
inline constexpr double kFittedView = 0.0;

struct Parameters {
  // image
  double rectified_fov_deg = kFittedView;
  double corner_min_eigenvalue = 5.0;
  double corner_min_distance_px = 6.0;
  int corners_max = 128;

  // odometry
  double distance_noise_per_sqrt_m = 0.001;
  double turn_noise_per_sqrt_m = 0.02;
  double lateral_noise_per_sqrt_m = 0.002;
  double odometry_floor_m = 0.0003;

  // filter
  int particles = 200;
  int optimal_proposal = 1;
  double pixel_sigma_px = 0.35;
  double gate_sigma = 3.5;
  double likelihood_cap = 9.0;
  double resample_below = 0.5;
  double min_travel_m = 0.005;
  double min_turn_deg = 0.3;
  double tilt_sigma_deg = 0.1;
  double principal_sigma_px = 0.1;
  double focal_sigma = 0.0;
  double wheel_scale_sigma = 0.002;
  double mount_yaw_sigma_deg = 0.05;

  // association
  double ncc_match = 0.65;
  double ncc_match_settled = 0.40;
  double ncc_new_appearance = 0.85;

  // map
  double min_height_m = 1.0;
  double max_height_m = 8.0;
  double anchor_distance_m = 0.10;
  int promote_observations = 5;
  double promote_height_sigma = 0.15;
  double loop_travel_m = 10.0;
  double loop_drift = 0.004;
  double loop_drift_deg_per_m = 0.03;
  int loop_min_inliers = 6;

  // fleet
  double ncc_overlap = 0.75;
  double confidence_threshold = 0.5;
};

struct ParameterInfo {
  std::string_view key;   // as in the struct
  std::string_view unit;  // "" when dimensionless
  double min = 0.0;
  double max = 0.0;
  std::string_view text;
  std::variant<double Parameters::*, int Parameters::*> field;
  bool may_be_auto =
      false;  // "auto" in files and on command lines, 0 here, stands beside the range

  bool allows(double value) const {
    return (value >= min && value <= max) || (may_be_auto && value == 0.0);
  }
};

std::span<const ParameterInfo> parameter_table();

// The same parameters, each within the table's range: one beyond stops at its end, one that is no
// number becomes the default. `limited`: how many were not within.
Parameters within_limits(const Parameters& given, int* limited = nullptr);

}  // namespace zenith
