#pragma once
// Confidence of an overlap over consecutive frames (paper III-B, Eq. 4, corrected).
//
//   confidence = exp( -(1/M) sum_i |d r_i - R d r*_i| / |d r_i| )
//
// d r_i: the robot's motion between two searches by its own filter; d r*_i: the motion of its place
// in the peer's map, each found from one frame, rotated into the own frame by the candidate's R. A
// search that found no place counts as 1 (as if the place had not moved), as do increments not yet
// there: confidence is earned over M increments.

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>

namespace zenith {

class Confidence {
 public:
  static constexpr int kIncrements = 6;  // M

  // One search in which the robot had moved far enough. `place` is r* (already rotated into the own
  // frame), `found` whether there is one.
  void add(const Eigen::Vector2d& robot, const Eigen::Vector2d& place, bool found) {
    double term = 1.0;
    if (found && had_place_) {
      const Eigen::Vector2d dr = robot - robot_;
      const Eigen::Vector2d dp = place - place_;
      const double moved = dr.norm();
      if (moved > 0.0) term = std::min((dr - dp).norm() / moved, kWorst);
    }
    terms_[static_cast<std::size_t>(next_)] = term;
    next_ = (next_ + 1) % kIncrements;
    robot_ = robot;
    place_ = place;
    had_place_ = found;
  }

  double value() const {
    double sum = 0.0;
    for (const double t : terms_) sum += t;
    return std::exp(-sum / kIncrements);
  }

 private:
  static constexpr double kWorst = 3.0;  // one wild increment must not outlast its window's worth

  static constexpr std::array<double, kIncrements> start() {
    std::array<double, kIncrements> terms{};
    terms.fill(1.0);
    return terms;
  }
  std::array<double, kIncrements> terms_ = start();
  int next_ = 0;
  Eigen::Vector2d robot_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d place_ = Eigen::Vector2d::Zero();
  bool had_place_ = false;
};

}  // namespace zenith
