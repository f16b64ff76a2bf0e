#pragma once
// Where everything of a team's map lies in one common frame: that of the first robot. A robot whose
// map was not merged (through others neither) is laid beside it, as it is in its own frame.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "slam/geometry.h"
#include "tools/runner/run_log.h"

namespace zenith::tools {

struct MapLandmark {
  Eigen::Vector2d position_m;
  Eigen::Matrix2d covariance_m2;
  int robot = 0;        // who saw it
  bool common = false;  // several robots hold it as one
};

struct PlacedRobot {
  std::string name;
  bool placed = false;  // its frame is known in the common one
  std::vector<Eigen::Vector2d> path;
  std::vector<Eigen::Vector2d> truth;  // laid over the estimates by the best rigid fit
};

struct MapLayout {
  std::vector<PlacedRobot> robots;
  std::vector<MapLandmark> landmarks;
  Eigen::Vector2d min_m;  // of what is worth showing: stray landmarks may lie outside
  Eigen::Vector2d max_m;

  bool holds(const Eigen::Vector2d& p) const {
    return (p.array() >= min_m.array()).all() && (p.array() <= max_m.array()).all();
  }
};

MapLayout lay_out_map(const TeamLog& log);

}  // namespace zenith::tools
