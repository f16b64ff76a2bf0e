#pragma once
// How long a test waits for what has to come. It is reached only when that never comes: no test
// depends on the computer's speed (tests/README.md).

#include "platform/base/time.h"

namespace zenith {

inline constexpr Duration kPatience = {600'000'000'000};
inline constexpr double kPatience_s = 600.0;

}  // namespace zenith
