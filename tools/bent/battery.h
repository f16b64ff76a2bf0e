#pragma once
// The battery: one drive made wrong in every way (bends.h), mapped, and asked whether its errors
// were told. A run is silent when its trajectory is off by more than kSilent_m and the verdict is
// good; an unbent run that is not good is a false alarm.

#include <functional>
#include <string>
#include <vector>

#include "slam/parameters.h"
#include "tools/report/figures.h"

namespace zenith::tools {

inline constexpr double kSilent_m = 0.08;

struct BatteryPlan {
  std::vector<std::string> worlds;
  std::uint64_t seed = 1;
  double duration_s = 0.0;  // of the drive, 0: as long as the world says
  int jobs = 1;
  bool quick = false;  // few bends
  Parameters parameters;
};

struct BatteryRun {
  std::string world;
  std::string bend;
  bool unbent = false;
  std::string failure;  // empty when it ran
  RobotFigures figures;

  bool silent() const;
  bool false_alarm() const;
};

using BatteryProgress = std::function<void(double fraction)>;

// The first robot of each world, bend by bend. A world that cannot be simulated is one failed run.
std::vector<BatteryRun> run_battery(const BatteryPlan& plan, const BatteryProgress& progress);

// A row each: error, wheels' error, verdict with its codes; and how many are silent.
std::string battery_text(const std::vector<BatteryRun>& runs);

}  // namespace zenith::tools
