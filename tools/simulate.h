#pragma once
// Writes the recordings of all robots of a simulated world.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "platform/base/result.h"

namespace zenith::tools {

// Whether each is one of the known worlds or an existing file; the error names near ones.
Status check_worlds(const std::vector<std::string>& worlds);

struct SimulatePlan {
  std::string world;
  std::uint64_t seed = 1;
  double duration_s = 0.0;            // 0: as long as the world says
  double max_view_angle_deg = 180.0;  // pixels farther from the axis stay black
};

// Into `folder`/<robot>/, which the caller keeps atomic; robots side by side, as many as there are
// cores. Returns the robots' names.
Result<std::vector<std::string>> write_simulation(const SimulatePlan& plan,
                                                  const std::filesystem::path& folder,
                                                  const std::function<void(double)>& progress);

}  // namespace zenith::tools
