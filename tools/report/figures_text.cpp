#include "tools/report/figures_text.h"

#include <numbers>

#include "tools/report/table.h"

namespace zenith::tools {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

std::string error_text(const std::optional<TransformError>& error) {
  if (!error) return "-";
  return fixed(error->position_m, 3) + " m " + fixed(error->angle_rad * kDegrees, 2) + "°" +
         (error->wrong() ? " WRONG" : "");
}

std::optional<double> ratio(const std::optional<double>& a, const std::optional<double>& b) {
  if (!a || !b || *b <= 0.0) return std::nullopt;
  return *a / *b;
}

std::string return_text(const std::optional<ReturnFigures>& loop) {
  if (!loop) return "-";
  return fixed(loop->before_m, 3) + " m (" + fixed(loop->percent(), 2) + " %) > " +
         fixed(loop->after_m, 3) + " m";
}

std::string jumps_text(const RobotFigures& robot) {
  if (!robot.jumps || !robot.wrong_jumps) return "-";
  return std::to_string(*robot.jumps) + ", " + std::to_string(*robot.wrong_jumps);
}

std::string robots_text(const TeamFigures& figures) {
  Table table({"robot", "way m", "ATE m", "odometry m", "ratio", "return, before > after",
               "jumps, wrong", "landmarks", "step ms med", "95 %", "max"});
  for (const RobotFigures& robot : figures.robots) {
    table.add({robot.name, fixed(robot.true_path_m ? *robot.true_path_m : robot.path_m, 1),
               fixed(robot.ate_m, 3), fixed(robot.odometry_ate_m, 3),
               fixed(ratio(robot.ate_m, robot.odometry_ate_m), 2), return_text(robot.loop),
               jumps_text(robot), std::to_string(robot.landmarks), fixed(robot.step.median_ms, 2),
               fixed(robot.step.p95_ms, 2), fixed(robot.step.max_ms, 2)});
  }
  return table.text(2);
}

std::string pair_name(const TeamFigures& figures, const PairFigures& pair) {
  return figures.robots[static_cast<std::size_t>(pair.own)].name + " < " +
         figures.robots[static_cast<std::size_t>(pair.peer)].name;
}

std::string pairs_text(const TeamFigures& figures) {
  Table table({"pair", "overlap s", "merge s", "driven m", "at merge", "20 s later", "at the end",
               "common", "double", "withdrawn", "false"});
  for (const PairFigures& pair : figures.pairs) {
    table.add({pair_name(figures, pair), fixed(pair.overlap_time_s, 1), fixed(pair.merge_time_s, 1),
               fixed(pair.driven_till_merge_m, 1), error_text(pair.at_merge),
               error_text(pair.later), error_text(pair.at_end), std::to_string(pair.fused),
               std::to_string(pair.duplicates), std::to_string(pair.withdrawn),
               std::to_string(pair.false_merges)});
  }
  return table.empty() ? "" : table.text(2);
}

// The values of one figure over all runs.
struct Collected {
  std::vector<double> ate, odometry, ratio, return_percent, return_after, step_median, step_p95,
      step_max;
  std::vector<double> driven, merge_m, merge_deg, later_m, later_deg, end_m, end_deg, circle_m;
  std::vector<double> nees;
  std::vector<double> through_m, through_deg, trip_m, trip_deg;
  int jumps = 0, wrong_jumps = 0;
  int robots = 0, pairs = 0, overlapping = 0, merged = 0, wrong = 0, false_merges = 0,
      withdrawn = 0, doubles = 0;
};

void collect_robot(const RobotFigures& robot, Collected& all) {
  ++all.robots;
  if (robot.ate_m) all.ate.push_back(*robot.ate_m);
  if (robot.odometry_ate_m) all.odometry.push_back(*robot.odometry_ate_m);
  if (const auto r = ratio(robot.ate_m, robot.odometry_ate_m)) all.ratio.push_back(*r);
  all.jumps += robot.jumps.value_or(0);
  all.wrong_jumps += robot.wrong_jumps.value_or(0);
  if (robot.loop) {
    all.return_percent.push_back(robot.loop->percent());
    all.return_after.push_back(robot.loop->after_m);
  }
  if (robot.end) all.nees.push_back(robot.end->nees);
  all.step_median.push_back(robot.step.median_ms);
  all.step_p95.push_back(robot.step.p95_ms);
  all.step_max.push_back(robot.step.max_ms);
}

void collect_error(const std::optional<TransformError>& error, std::vector<double>& metres,
                   std::vector<double>& degrees) {
  if (!error) return;
  metres.push_back(error->position_m);
  degrees.push_back(error->angle_rad * kDegrees);
}

void collect_pair(const PairFigures& pair, Collected& all) {
  ++all.pairs;
  all.overlapping += pair.overlap_time_s ? 1 : 0;
  all.merged += pair.merged_at_end ? 1 : 0;
  all.wrong += pair.at_end && pair.at_end->wrong() ? 1 : 0;
  all.false_merges += pair.false_merges;
  all.withdrawn += pair.withdrawn;
  all.doubles += pair.duplicates;
  if (pair.driven_till_merge_m) all.driven.push_back(*pair.driven_till_merge_m);
  collect_error(pair.at_merge, all.merge_m, all.merge_deg);
  collect_error(pair.later, all.later_m, all.later_deg);
  collect_error(pair.at_end, all.end_m, all.end_deg);
  collect_error(pair.through_others, all.through_m, all.through_deg);
  collect_error(pair.round_trip, all.trip_m, all.trip_deg);
}

std::string error_summary(const std::vector<double>& metres, const std::vector<double>& degrees) {
  if (metres.empty()) return "-";
  return median_and_worst(metres, 3) + " m, " + median_and_worst(degrees, 2) + "°";
}

// How well camera and wheels can have been compared: turns alone show a wrong metre.
std::string metre_text(const SetupMeasures& setup) {
  constexpr double kNothing = 0.2;
  if (!setup.judged) return "";
  if (setup.metre_checked_to > kNothing) {
    return "; the wheels' metre is unchecked: turn by 90 degrees and more";
  }
  return "; the wheels' metre is checked to " + fixed(100.0 * setup.metre_checked_to, 1) + " %";
}

}  // namespace

std::string verdicts_text(const TeamFigures& figures) {
  std::string text;
  for (const RobotFigures& robot : figures.robots) {
    if (!robot.verdict) continue;
    text += "  set-up of " + robot.name + ": " + std::string(verdict_name(robot.verdict->state));
    text += metre_text(robot.setup) + "\n";
    for (const Reason& reason : robot.verdict->reasons) {
      text += "    " + std::string(setup_code_name(reason.code)) + ", since " +
              fixed(reason.since_s, 1) + " s: " + std::string(reason_text(reason).view()) + "\n";
    }
  }
  return text;
}

bool is_wrong(const TeamFigures& figures) {
  return std::any_of(figures.robots.begin(), figures.robots.end(), [](const RobotFigures& robot) {
    return robot.verdict && robot.verdict->state == VerdictState::kWrong;
  });
}

std::string figures_text(const TeamFigures& figures) {
  std::string text = robots_text(figures) + pairs_text(figures);
  for (const PairFigures& pair : figures.pairs) {
    if (!pair.through_others) continue;
    text += "  " + pair_name(figures, pair) +
            " through others: " + error_text(pair.through_others) + "\n";
  }
  if (figures.circle) text += "  circle of transforms: " + error_text(figures.circle) + "\n";
  return text;
}

std::string summary_text(std::span<const TeamFigures> runs) {
  Collected all;
  for (const TeamFigures& run : runs) {
    for (const RobotFigures& robot : run.robots) collect_robot(robot, all);
    for (const PairFigures& pair : run.pairs) collect_pair(pair, all);
    if (run.circle) all.circle_m.push_back(run.circle->position_m);
  }
  Table table({"figure", "median / worst"});
  table.add({"ATE m", median_and_worst(all.ate, 3)});
  table.add({"ATE of odometry alone m", median_and_worst(all.odometry, 3)});
  table.add({"ratio of the two", median_and_worst(all.ratio, 2)});
  if (!all.nees.empty()) {
    table.add({"NEES of the last pose (3 is honest)", median_and_worst(all.nees, 1)});
  }
  if (!all.return_percent.empty()) {
    table.add({"error at the return, % of way", median_and_worst(all.return_percent, 2)});
    table.add({"error after the return m", median_and_worst(all.return_after, 3)});
  }
  table.add({"jumps of the pose", std::to_string(all.jumps)});
  table.add({"of these wrong", std::to_string(all.wrong_jumps)});
  if (all.pairs > 0) {
    table.add({"pairs, each way (a robot comes where the other was)",
               std::to_string(all.pairs) + " (" + std::to_string(all.overlapping) + ")"});
    table.add({"merged at the end", std::to_string(all.merged)});
    table.add({"of these wrong", std::to_string(all.wrong)});
    table.add({"merges wrong at their moment", std::to_string(all.false_merges)});
    table.add({"merges withdrawn", std::to_string(all.withdrawn)});
    table.add({"driven in the overlap till merge m", median_and_worst(all.driven, 1)});
    table.add({"transform error at merge", error_summary(all.merge_m, all.merge_deg)});
    table.add({"transform error 20 s later", error_summary(all.later_m, all.later_deg)});
    table.add({"transform error at the end", error_summary(all.end_m, all.end_deg)});
    if (!all.through_m.empty()) {
      table.add({"transform error through others", error_summary(all.through_m, all.through_deg)});
    }
    table.add({"there and back again", error_summary(all.trip_m, all.trip_deg)});
    table.add({"landmarks left double", std::to_string(all.doubles)});
  }
  if (!all.circle_m.empty()) table.add({"circle closure m", median_and_worst(all.circle_m, 3)});
  table.add({"step median ms", median_and_worst(all.step_median, 2)});
  table.add({"step 95 % ms", median_and_worst(all.step_p95, 2)});
  table.add({"step longest ms", median_and_worst(all.step_max, 2)});
  return table.text(2);
}

}  // namespace zenith::tools
