#pragma once
// robots[].clock of summary.json: what was added to the stamps of a recording.

#include <nlohmann/json.hpp>

#include "tools/clocks/alignment.h"

namespace zenith::tools {

inline nlohmann::json shift_json(const ClockShift& shift) {
  nlohmann::json pieces = nlohmann::json::array();
  for (const ClockShift::Piece& p : shift.pieces()) {
    pieces.push_back({{"from_ns", p.from.ns}, {"offset_ns", p.offset.ns}});
  }
  return pieces;
}

// Throws as nlohmann::json does. Of an output without it: no shift.
inline ClockShift shift_of_json(const nlohmann::json& robot) {
  ClockShift shift;
  if (!robot.contains("clock")) return shift;
  for (const nlohmann::json& p : robot.at("clock")) {
    shift.add({p.at("from_ns").get<std::int64_t>()}, {p.at("offset_ns").get<std::int64_t>()});
  }
  return shift;
}

}  // namespace zenith::tools
