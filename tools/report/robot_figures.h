#pragma once
// The part of judge() that looks at one robot alone.

#include "tools/report/figures.h"

namespace zenith::tools {

RobotFigures judge_robot(const RobotLog& log);
StepTimes judge_steps(const RobotLog& log);

}  // namespace zenith::tools
