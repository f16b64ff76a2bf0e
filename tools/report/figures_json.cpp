#include <cmath>
#include <numbers>

#include "tools/report/figures_text.h"

namespace zenith::tools {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

nlohmann::json optional_json(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::json error_json(const std::optional<TransformError>& error) {
  if (!error) return {};
  return {{"position_m", error->position_m},
          {"angle_deg", error->angle_rad * kDegrees},
          {"wrong", error->wrong()}};
}

nlohmann::json verdict_json(const SetupVerdict& verdict) {
  nlohmann::json reasons = nlohmann::json::array();
  for (const Reason& reason : verdict.reasons) {
    reasons.push_back({{"code", setup_code_name(reason.code)},
                       {"text", reason_text(reason).view()},
                       {"since_s", reason.since_s}});
  }
  return {{"state", verdict_name(verdict.state)}, {"reasons", reasons}};
}

// Figures of the comparison of camera and wheels; null where there was not enough to compare.
nlohmann::json setup_json(const SetupMeasures& m) {
  if (!m.judged) return {};
  return {{"intervals", m.intervals},
          {"turn_scale", m.turn_scale},
          {"wheel_balance", m.wheel_balance},
          {"yaw_error_deg", m.yaw_error_rad * kDegrees},
          {"height_m", m.height_m},
          {"wheels_late_ms", 1e3 * m.delay_s},
          {"stamps_jitter_ms", 1e3 * m.jitter_s},
          {"metre_checked_to", m.metre_checked_to},
          {"focal_error", m.lens.focal},
          {"focal_error_sigma", m.lens.focal_sigma},
          {"axis_ahead_deg", std::atan(m.lens.ahead) * kDegrees},
          {"axis_ahead_sigma_deg", std::atan(m.lens.ahead_sigma) * kDegrees},
          {"corners_standing", m.standing},
          {"turns_unexplained", m.unexplained},
          {"vertical_off_deg", std::atan(m.vertical.norm()) * kDegrees}};
}

nlohmann::json robot_json(const RobotFigures& robot) {
  nlohmann::json json = {
      {"name", robot.name},
      {"frames", robot.frames},
      {"duration_s", robot.duration_s},
      {"path_m", robot.path_m},
      {"true_path_m", optional_json(robot.true_path_m)},
      {"ate_m", optional_json(robot.ate_m)},
      {"odometry_ate_m", optional_json(robot.odometry_ate_m)},
      {"jumps", robot.jumps ? nlohmann::json(*robot.jumps) : nlohmann::json()},
      {"wrong_jumps", robot.wrong_jumps ? nlohmann::json(*robot.wrong_jumps) : nlohmann::json()},
      {"landmarks", robot.landmarks},
      {"step_ms",
       {{"median", robot.step.median_ms}, {"p95", robot.step.p95_ms}, {"max", robot.step.max_ms}}}};
  if (robot.verdict) json["verdict"] = verdict_json(*robot.verdict);
  json["setup"] = setup_json(robot.setup);
  if (robot.loop) {
    json["return"] = {{"time_s", robot.loop->time_s},
                      {"driven_m", robot.loop->driven_m},
                      {"before_m", robot.loop->before_m},
                      {"before_percent", robot.loop->percent()},
                      {"after_m", robot.loop->after_m}};
  }
  if (robot.end) {
    json["end"] = {{"position_m", robot.end->position_m},
                   {"angle_deg", robot.end->angle_rad * kDegrees},
                   {"stated_position_m", robot.end->stated_position_m},
                   {"stated_angle_deg", robot.end->stated_angle_rad * kDegrees},
                   {"nees", robot.end->nees}};
  }
  return json;
}

nlohmann::json pair_json(const TeamFigures& figures, const PairFigures& pair) {
  return {{"robot", figures.robots[static_cast<std::size_t>(pair.own)].name},
          {"peer", figures.robots[static_cast<std::size_t>(pair.peer)].name},
          {"merges", pair.merges},
          {"merged_at_end", pair.merged_at_end},
          {"withdrawn", pair.withdrawn},
          {"false_merges", pair.false_merges},
          {"merge_time_s", optional_json(pair.merge_time_s)},
          {"overlap_time_s", optional_json(pair.overlap_time_s)},
          {"driven_till_merge_m", optional_json(pair.driven_till_merge_m)},
          {"error_at_merge", error_json(pair.at_merge)},
          {"error_20_s_later", error_json(pair.later)},
          {"error_at_end", error_json(pair.at_end)},
          {"error_through_others", error_json(pair.through_others)},
          {"round_trip", error_json(pair.round_trip)},
          {"fused_landmarks", pair.fused},
          {"duplicates", pair.duplicates}};
}

}  // namespace

nlohmann::json figures_json(const TeamFigures& figures) {
  nlohmann::json json = {{"robots", nlohmann::json::array()}, {"pairs", nlohmann::json::array()}};
  for (const RobotFigures& robot : figures.robots) json["robots"].push_back(robot_json(robot));
  for (const PairFigures& pair : figures.pairs) json["pairs"].push_back(pair_json(figures, pair));
  json["circle_closure"] = error_json(figures.circle);
  return json;
}

}  // namespace zenith::tools
