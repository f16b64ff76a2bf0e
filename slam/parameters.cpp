#include "slam/parameters.h"

#include <array>
#include <cmath>
#include <type_traits>

namespace zenith {
namespace {

using P = Parameters;

constexpr auto kTable = std::to_array<ParameterInfo>({
    {"rectified_fov_deg", "deg", 10, 150,
     "field of view of the rectified image, side to side; auto: all that the lens shows, up to 112",
     &P::rectified_fov_deg, true},
    {"corner_min_eigenvalue", "grey2/px2", 0, 1000,
     "weaker corners are taken for noise; lower it for dim or plain ceilings",
     &P::corner_min_eigenvalue},
    {"corner_min_distance_px", "px", 2, 40, "least distance of two corners",
     &P::corner_min_distance_px},
    {"corners_max", "", 8, 128, "corners taken from one frame", &P::corners_max},

    {"distance_noise_per_sqrt_m", "m/sqrt(m)", 0, 0.5,
     "standard deviation of the odometry's distance after one metre",
     &P::distance_noise_per_sqrt_m},
    {"turn_noise_per_sqrt_m", "rad/sqrt(m)", 0, 1,
     "standard deviation of the odometry's heading after one metre", &P::turn_noise_per_sqrt_m},
    {"lateral_noise_per_sqrt_m", "m/sqrt(m)", 0, 0.5,
     "standard deviation of sideways slip after one metre", &P::lateral_noise_per_sqrt_m},
    {"odometry_floor_m", "m", 0, 0.1,
     "standard deviation of a wheel's travel between two frames: quantisation, backlash",
     &P::odometry_floor_m},

    {"particles", "", 1, 1024, "number of particles", &P::particles},
    {"optimal_proposal", "", 0, 1,
     "1: draw poses from odometry and landmarks (FastSLAM 2.0); 0: from odometry alone, the "
     "paper's",
     &P::optimal_proposal},
    {"pixel_sigma_px", "px", 0.05, 10,
     "least standard deviation of a corner's position, in pixels of the fisheye frame; more is "
     "learned while driving",
     &P::pixel_sigma_px},
    {"gate_sigma", "", 1, 10, "matches further than this from their prediction are refused",
     &P::gate_sigma},
    {"likelihood_cap", "", 1, 100,
     "most that one landmark can count against a particle, as squared sigmas", &P::likelihood_cap},
    {"resample_below", "", 0, 1,
     "resample when the effective share of the particles falls below this", &P::resample_below},
    {"min_travel_m", "m", 0, 1, "frames nearer than this to the last used one are not used",
     &P::min_travel_m},
    {"min_turn_deg", "deg", 0, 45, "nor those turned by less than this", &P::min_turn_deg},
    {"tilt_sigma_deg", "deg", 0, 5,
     "how wrong the calibrated tilt of the camera may be; the rest is learned while driving; 0: "
     "off",
     &P::tilt_sigma_deg},
    {"principal_sigma_px", "px", 0, 10, "the same of the principal point; 0: taken as calibrated",
     &P::principal_sigma_px},
    {"focal_sigma", "", 0, 0.1, "the same of the focal length, relative; 0: taken as calibrated",
     &P::focal_sigma},

    {"wheel_scale_sigma", "", 0, 0.2,
     "how wrong the common scale of both wheels may be, relative: no camera sees it",
     &P::wheel_scale_sigma},
    {"mount_yaw_sigma_deg", "deg", 0, 20,
     "how wrong the calibrated yaw of the camera may be; for the stated covariances alone",
     &P::mount_yaw_sigma_deg},

    {"ncc_match", "", -1, 1, "least similarity of a corner and its landmark", &P::ncc_match},
    {"ncc_match_settled", "", -1, 1,
     "the same once the other matches fix the pose, so that changed looks are learned",
     &P::ncc_match_settled},
    {"ncc_new_appearance", "", -1, 1, "a landmark's look below this similarity is stored as new",
     &P::ncc_new_appearance},

    {"min_height_m", "m", 0.4, 100, "lowest landmark above the floor", &P::min_height_m},
    {"max_height_m", "m", 0.4, 100, "highest landmark above the floor", &P::max_height_m},
    {"anchor_distance_m", "m", 0, 5, "way between two frames that may start new landmarks",
     &P::anchor_distance_m},
    {"promote_observations", "", 2, 100, "observations before a landmark is promoted",
     &P::promote_observations},
    {"promote_height_sigma", "", 0.01, 1, "relative uncertainty of its height by then",
     &P::promote_height_sigma},
    {"loop_travel_m", "m", 1, 1000, "a landmark not seen for this way may close a loop",
     &P::loop_travel_m},
    {"loop_drift", "", 0, 0.1, "drift of the position to reckon with, as share of the way",
     &P::loop_drift},
    {"loop_drift_deg_per_m", "deg/m", 0, 5, "drift of the heading to reckon with",
     &P::loop_drift_deg_per_m},
    {"loop_min_inliers", "", 3, 100, "old landmarks that must agree to close a loop",
     &P::loop_min_inliers},

    {"ncc_overlap", "", -1, 1, "least similarity of a corner and a peer's landmark",
     &P::ncc_overlap},
    {"confidence_threshold", "", 0, 1, "confidence (Eq. 4) from which a merge is allowed",
     &P::confidence_threshold},
});

}  // namespace

std::span<const ParameterInfo> parameter_table() {
  return kTable;
}

Parameters within_limits(const Parameters& given, int* limited) {
  Parameters out = given;
  int count = 0;
  for (const ParameterInfo& info : kTable) {
    std::visit(
        [&](auto field) {
          const auto value = static_cast<double>(given.*field);
          if (info.allows(value)) return;
          using Number = std::remove_reference_t<decltype(out.*field)>;
          out.*field = std::isnan(value)
                           ? Parameters{}.*field
                           : static_cast<Number>(value < info.min ? info.min : info.max);
          ++count;
        },
        info.field);
  }
  if (limited != nullptr) *limited = count;
  return out;
}

}  // namespace zenith
