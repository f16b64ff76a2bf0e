#pragma once
// From a recorded drive to mount and wheels that can be trusted, or to how to drive again.

#include <optional>
#include <string>
#include <vector>

#include "tools/calibrate/drive_setup.h"
#include "tools/calibrate/drive_solver.h"
#include "tools/calibrate/judgement.h"

namespace zenith::tools {

// What a person measured: the only ways to the length of a metre.
struct DriveReferences {
  std::optional<double> distance_m;  // between where the robot stood first and last
  std::optional<double> ceiling_m;   // of most of the ceiling, above the floor
};

struct DriveEstimate {
  std::string key;  // of the configuration
  std::string unit;
  double before = 0.0;
  double value = 0.0;
  double sigma = 0.0;
  double good = 0.0;       // sigma below this
  double usable = 0.0;     // and below this; else the drive does not show it
  std::string advice;      // when it does not
  std::string doubt = {};  // why it cannot be, all the same; empty: it can

  bool shown() const { return sigma <= usable && doubt.empty(); }
};

struct DriveCalibration {
  DriveSetup setup;  // what was mended before
  DriveSolution solution;
  std::vector<DriveEstimate> estimates;
  RobotConfig robot;       // as it was, mended, with what the drive showed
  double latency_s = 0.0;  // beyond what was known
  double driven_m = 0.0;
  double turned_deg = 0.0;  // in all, to both sides
  int images = 0;
  bool scale_known = false;
  std::optional<double> ceiling_m;  // of most of the ceiling, above the camera
  Judgement judgement;
};

DriveCalibration calibrate_drive(const DriveData& data, const DriveReferences& references);

std::string drive_report(const DriveCalibration& calibration);

}  // namespace zenith::tools
