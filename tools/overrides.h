#pragma once
// `--set key=value` on the command line: changes to the parameters of slam/parameters.h.

#include <string>
#include <vector>

#include "platform/base/result.h"
#include "slam/parameters.h"

namespace zenith::tools {

// Applies all assignments, or tells everything that is wrong with them in one message: unknown
// keys with the nearest known ones, values that are no numbers, values out of range.
Result<Parameters> apply_overrides(const Parameters& base,
                                   const std::vector<std::string>& assignments);

// One line a parameter: key, default, range, unit, text.
std::string describe_parameters();

}  // namespace zenith::tools
