#pragma once
// Figures as tables for a person, and as JSON for a program.

#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "tools/report/figures.h"

namespace zenith::tools {

// One run: a table of the robots, a table of the pairs that merged.
std::string figures_text(const TeamFigures& figures);

// A line for each robot's verdict on its set-up, and one for each reason.
std::string verdicts_text(const TeamFigures& figures);

// Whether a robot's set-up was found wrong.
bool is_wrong(const TeamFigures& figures);

// Several runs of one world: each figure as median / worst.
std::string summary_text(std::span<const TeamFigures> runs);

nlohmann::json figures_json(const TeamFigures& figures);

}  // namespace zenith::tools
