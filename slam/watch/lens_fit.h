#pragma once
// Whether the lens is as configured, from how corners move while the robot drives straight.
//
// Under any ceiling, whatever its heights, corners move along the image's common motion s, and none
// across it. A wide lens with another focal length stretches the image along the radius otherwise
// than across it, so that corners beside the line of motion swerve; seen from an axis that is not
// where it is configured to be, they converge:
//
//   focal length     z' = (1 + e g(r)) z,   g(r) = (1 + r^2) atan(r) / r       equidistant
//   principal point  z' = (1 + r^2 / 3) (z + o) + 2/3 z (z . o)                to the second order
//   across s:        y = s^ x d = c0 + c1 (z . s^) + e q + o_x p
//                    q = g'(r) / r (z . s^) (s^ x z) (s^ . d),   p = 2/3 (s^ x z) d_x
//
// d: how the corner moved, z: its place in the middle of that, x: ahead; c0 and c1 take what the
// motion's own fit is off by. Least squares over all intervals, the two marginalised in each. A
// lens that shows straight lines straight has g' = 0: with it another focal length is another
// height of the ceiling and nothing else.

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/LU>

namespace zenith {

// What the corners of one interval tell of (e, o_x).
struct LensEvidence {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  double squares = 0.0;  // of y, without c0 and c1
  double freedom = 0.0;  // corners less two
};

class LensInterval {
 public:
  // `shift`: s; tangents.
  explicit LensInterval(const Eigen::Vector2d& shift)
      : along_(shift / std::max(shift.norm(), 1e-9)), across_(-along_.y(), along_.x()) {}

  void add(const Eigen::Vector2d& z, const Eigen::Vector2d& moved) {
    const double r = z.norm();
    if (r < 0.05) return;
    const double slope = (1.0 - 1.0 / (r * r)) * std::atan(r) + 1.0 / r;
    const double beside = z.dot(across_);
    const Eigen::Vector2d p(slope / r * z.dot(along_) * beside * moved.dot(along_),
                            2.0 / 3.0 * beside * moved.x());
    const double y = moved.dot(across_);
    const Eigen::Vector2d c(1.0, z.dot(along_));
    cc_ += c * c.transpose();
    cp_ += c * p.transpose();
    cy_ += c * y;
    pp_ += p * p.transpose();
    py_ += p * y;
    yy_ += y * y;
    ++corners_;
  }

  LensEvidence evidence() const {
    if (corners_ < kLeastCorners || !(cc_.determinant() > 1e-9)) return {};
    const Eigen::Matrix2d inverse = cc_.inverse();
    return {pp_ - cp_.transpose() * inverse * cp_, py_ - cp_.transpose() * inverse * cy_,
            yy_ - cy_.dot(inverse * cy_), corners_ - 2.0};
  }

 private:
  static constexpr int kLeastCorners = 8;

  Eigen::Vector2d along_;
  Eigen::Vector2d across_;
  Eigen::Matrix2d cc_ = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d cp_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d cy_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d pp_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d py_ = Eigen::Vector2d::Zero();
  double yy_ = 0.0;
  int corners_ = 0;
};

struct LensError {
  double focal = 0.0;  // relative; of the first order
  double ahead = 0.0;  // the principal point, in focal lengths; a tilt counts half as much more
  double focal_sigma = 1.0;
  double ahead_sigma = 1.0;
};

class LensFit {
 public:
  void add(const LensEvidence& e, double fade) {
    sum_.information = fade * sum_.information + e.information;
    sum_.moment = fade * sum_.moment + e.moment;
    sum_.squares = fade * sum_.squares + e.squares;
    sum_.freedom = fade * sum_.freedom + e.freedom;
  }

  LensError error() const {
    if (sum_.freedom < kLeastFreedom || !(sum_.information.determinant() > 1e-12)) return {};
    const Eigen::Matrix2d inverse = sum_.information.inverse();
    const Eigen::Vector2d e = inverse * sum_.moment;
    const double rest = std::max(sum_.squares - e.dot(sum_.moment), 0.0) / sum_.freedom;
    const auto sigma = [&](int i) { return kLasting * std::sqrt(rest * inverse(i, i)); };
    return {e[0], e[1], sigma(0), sigma(1)};
  }

 private:
  // A corner's error lasts, so that intervals tell less than they say.
  static constexpr double kLasting = 2.0;
  static constexpr double kLeastFreedom = 200.0;

  LensEvidence sum_;
};

}  // namespace zenith
