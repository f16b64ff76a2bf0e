#pragma once
// Many runs of simulated teams, several at a time.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "slam/parameters.h"
#include "tools/report/figures.h"
#include "tools/runner/team.h"

namespace zenith::tools {

struct EvaluationPlan {
  std::vector<std::string> worlds;
  std::uint64_t first_seed = 1;
  int seeds = 1;
  double duration_s = 0.0;  // 0: as long as the world says
  int jobs = 1;             // threads; step times are honest with one only
  MapSharing sharing = MapSharing::kAsSent;
  bool joint = false;  // aligned robots go on in one filter
  Parameters parameters;
};

struct EvaluationRun {
  std::string world;
  std::uint64_t seed = 0;
  std::string failure;  // empty when it ran
  TeamFigures figures;
  std::optional<JointLog> joint;
};

struct EvaluationEvents {
  std::function<void(double fraction)> progress;
  std::function<void(const EvaluationRun&)> done;  // one call at a time, in order of completion
};

// In the order of worlds, then seeds.
std::vector<EvaluationRun> evaluate(const EvaluationPlan& plan, const EvaluationEvents& events);

}  // namespace zenith::tools
