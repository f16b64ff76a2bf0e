#pragma once
// What is known of the robots as text for Prometheus (its exposition format 0.0.4). Each metric has
// its unit in its name and a HELP; docs/metrics.md lists them.

#include <span>
#include <string>

#include "tools/view/fleet_state.h"

namespace zenith::tools {

inline constexpr const char* kMetricsType = "text/plain; version=0.0.4; charset=utf-8";

std::string metrics_text(const FleetState& state);

// For the reference page: name, kind, unit and help of each.
struct MetricText {
  std::string name;
  std::string kind;  // "gauge", "counter"
  std::string labels;
  std::string help;
};
std::span<const MetricText> metric_texts();

}  // namespace zenith::tools
