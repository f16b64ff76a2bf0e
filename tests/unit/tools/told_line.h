#pragma once
// Lines of telemetry that tests make as JSON, through the decoder that all lines come through.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tools/view/fleet_state.h"
#include "tools/view/telemetry_line.h"

namespace zenith::tools {

// Empty, and a failure of the test, when it is none.
inline TelemetryLine told(const nlohmann::json& line) {
  const DecodedLine decoded = decode_telemetry(line.dump());
  EXPECT_TRUE(decoded.line) << line << ": " << fault_name(decoded.fault) << " " << decoded.field;
  return decoded.line.value_or(TelemetryLine());
}

// As zenith view takes in what comes: what is no line is counted.
inline void hear(FleetState& state, std::size_t robot, std::string_view text) {
  const DecodedLine decoded = decode_telemetry(text);
  if (decoded.line) {
    state.apply(robot, *decoded.line);
  } else {
    state.count_refused(robot, decoded.fault);
  }
}

}  // namespace zenith::tools
