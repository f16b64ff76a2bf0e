#pragma once
// What the particles cannot know of their own error: how far the map has drifted from its start.
//
// Particles are resampled by what the last frames tell, so after some metres all of them share one
// past, and their spread says nothing of it. Beside the filter runs a covariance of the pose's
// error in the start frame, as a mean of what the landmarks in view carry:
//
//   D_pose = mean over the matched landmarks of  T D_a T^T + q |c - c_a|,   T = [I | J (c - c_a);
//   1]
//
// D_a is the covariance of the landmark's anchor, c and c_a the places of camera and anchor, J the
// turn by 90 degrees: an anchor whose heading is off by dtheta puts what is seen from afar off by
// J (c - c_a) dtheta. A new anchor gets the pose's D. All anchors' errors are taken as fully
// correlated, which is what a map that was built along one way is, and an upper bound else. When a
// loop closes, landmarks of old anchors bring their small D back.
//
// The growth q for each metre from an anchor: corners that slide with the view, edges and gloss,
// push all landmarks of a view in the same direction, so their number does not average it out. Of
// the corners' variance sigma^2 (tangents squared) a share persists over about one height h above
// the camera:
//
//   heading  kShare sigma^2 / h   rad^2/m,     place  kShare sigma^2 h   m^2/m
//
// Two errors belong to the whole map, at the place p in the start frame: wheels whose common scale
// is wrong (no camera sees it), and a mount whose yaw is wrong, which turns the way against the
// heading:  scale^2 p p^T + yaw^2 (J p)(J p)^T.

#include <Eigen/Core>

#include "slam/geometry.h"

namespace zenith {

// The drift's covariance at one place, over (x, y, theta), start frame.
struct PlacedDrift {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float covariance[6] = {};  // xx xy xt yy yt tt

  Eigen::Matrix3d matrix() const;
  // In another frame.
  PlacedDrift moved(const Pose2& T_to_from) const;
  void set(const Eigen::Vector2d& at_m, const Eigen::Matrix3d& D);
};

// The same, seen from elsewhere.
Eigen::Matrix3d carried_drift(const PlacedDrift& drift, const Eigen::Vector2d& to_m);

// How wrong the calibration of wheels and mount may be: standard deviations.
struct MapErrors {
  double scale = 0.0;
  double yaw_rad = 0.0;
};
Eigen::Matrix2d map_error(const MapErrors& errors, const Eigen::Vector2d& at_m);

class DriftEstimate {
 public:
  void begin_frame(const Eigen::Vector2d& camera_m) {
    camera_m_ = camera_m;
    sum_.setZero();
    count_ = 0;
  }
  // A matched landmark: its anchor's drift, its height above the camera, the corner's variance.
  void add(const PlacedDrift& anchor, double height_m, double noise);
  // Frames with few matches leave it as it was, carried along.
  void end_frame();

  // Of the pose, at the camera of the last frame.
  const Eigen::Matrix3d& covariance() const { return covariance_; }
  PlacedDrift placed() const;

 private:
  Eigen::Vector2d camera_m_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d last_m_ = Eigen::Vector2d::Zero();
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d sum_ = Eigen::Matrix3d::Zero();
  int count_ = 0;
};

}  // namespace zenith
