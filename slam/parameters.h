#pragma once
// The algorithm's parameters: one struct, and one table with each parameter's key, unit, range and
// text, from which parsing (`--set key=value`, TOML), checks and the reference page come.

#include <span>
#include <string_view>
#include <variant>

namespace zenith {

struct Parameters {
  // image
  double rectified_fov_deg = 120.0;
  double corner_relative_threshold = 0.002;
  double corner_min_distance_px = 7.0;
  int corners_max = 128;

  // filter
  int particles = 200;
  int proposal_optimal = 1;
  double wheel_sigma_per_sqrt_m = 0.01;
  double wheel_sigma_floor_m = 0.0005;
  double slip_sigma_per_rad = 0.02;
  double pixel_sigma_px = 0.7;
  double gate_sigma = 3.5;
  double resample_fraction = 0.5;

  // map
  double ncc_associate = 0.65;
  double ncc_new_appearance = 0.85;
  double min_height_m = 1.0;
  double max_height_m = 8.0;
  double anchor_distance_m = 0.10;

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
};

std::span<const ParameterInfo> parameter_table();

}  // namespace zenith
