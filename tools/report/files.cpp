#include "tools/report/files.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

#include "platform/recording/ground_truth.h"
#include "platform/recording/seconds.h"
#include "tools/atomic_output.h"
#include "tools/clocks/shift_json.h"
#include "tools/report/figures_text.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;

[[gnu::format(printf, 2, 3)]] void append(std::string& text, const char* format, ...) {
  char line[320];
  va_list values;
  va_start(values, format);
  std::vsnprintf(line, sizeof line, format, values);
  va_end(values);
  text += line;
}

std::string trajectory_text(const RobotLog& robot) {
  std::string text = "# timestamp x y z qx qy qz qw, base_link in the robot's own start frame\n";
  for (const FrameLog& frame : robot.frames) {
    text += format_tum({frame.stamp, frame.T_start_robot});
  }
  return text;
}

std::string landmarks_text(const RobotLog& robot) {
  std::string text = "id,x_m,y_m,z_m,var_xx,var_xy,var_yy,var_zz,observations\n";
  for (const LandmarkEstimate& mark : robot.landmarks) {
    const auto& P = mark.covariance_m2;
    append(text, "%u,%.5f,%.5f,%.5f,%.4g,%.4g,%.4g,%.4g,%d\n", mark.id, mark.position_m.x(),
           mark.position_m.y(), mark.position_m.z(), P(0, 0), P(0, 1), P(1, 1), P(2, 2),
           mark.observations);
  }
  return text;
}

std::string alignment_row(Time stamp, const PeerLog& view, const std::string& peer) {
  const Pose2& T = view.T_own_peer;
  const Eigen::Vector3d& v = view.variance;
  std::string row = format_seconds(stamp) + "," + peer;
  append(row, ",%s,%.6f,%.6f,%.8f,%.4g,%.4g,%.4g,%.4f,%d\n", state_name(view.state), T.x_m, T.y_m,
         T.theta_rad, v.x(), v.y(), v.z(), view.confidence, view.correspondences);
  return row;
}

std::string alignments_text(const TeamLog& log, const RobotLog& robot) {
  std::string text =
      "time_s,peer,state,x_m,y_m,theta_rad,var_x,var_y,var_theta,confidence,correspondences\n";
  for (std::size_t peer = 0; peer < log.robots.size(); ++peer) {
    const std::string& name = log.robots[peer].name;
    const PeerLog* last = nullptr;
    Time written;
    for (const FrameLog& frame : robot.frames) {
      const PeerLog* view = find_peer(frame, static_cast<int>(peer));
      if (view == nullptr) {
        // A candidate that is gone leaves no row; a merge that is gone was withdrawn.
        if (last != nullptr && last->state == AlignmentState::kMerged) {
          PeerLog gone = *last;
          gone.state = AlignmentState::kWithdrawn;
          text += alignment_row(frame.stamp, gone, name);
        }
        last = nullptr;
        continue;
      }
      const bool changed = last == nullptr || view->state != last->state;
      const bool due = changed || (frame.stamp - written).seconds() >= 1.0;
      last = view;
      if (!due && &frame != &robot.frames.back()) continue;
      written = frame.stamp;
      text += alignment_row(frame.stamp, *view, name);
    }
  }
  return text;
}

std::string confidence_text(const TeamLog& log, std::size_t own) {
  std::string text = "frame,time_s,peer,confidence\n";
  const RobotLog& robot = log.robots[own];
  for (std::size_t i = 0; i < robot.frames.size(); ++i) {
    for (std::size_t peer = 0; peer < log.robots.size(); ++peer) {
      if (peer == own) continue;
      const PeerLog* view = find_peer(robot.frames[i], static_cast<int>(peer));
      text += std::to_string(i) + "," + format_seconds(robot.frames[i].stamp) + "," +
              log.robots[peer].name;
      append(text, ",%.4f\n", view == nullptr ? 0.0 : view->confidence);
    }
  }
  return text;
}

nlohmann::json counters_json(const StepCounters& c) {
  nlohmann::json repairs;
  for (const RepairKind& kind : kRepairKinds) repairs[kind.name] = c.mapper.repairs.*kind.count;
  return {{"frames", c.frames},
          {"frames_refused", c.frames_refused},
          {"frames_repeated", c.frames_repeated},
          {"odometry_extrapolated", c.odometry_extrapolated},
          {"odometry_rejected", c.odometry_rejected},
          {"odometry_jumps", c.odometry_jumps},
          {"records_refused", c.records_refused},
          {"parameters_limited", c.parameters_limited},
          {"repairs", repairs},
          {"slips", c.mapper.slips},
          {"poses_recovered", c.mapper.poses_recovered},
          {"frames_held", c.mapper.frames_held},
          {"times_lost", c.mapper.times_lost},
          {"relocalised", c.mapper.relocalised},
          {"frames_blind", c.mapper.frames_blind},
          {"begun_anew", c.mapper.begun_anew},
          {"loops_closed", c.mapper.loops_closed},
          {"resamplings", c.mapper.resamplings},
          {"landmarks_created", c.mapper.landmarks_created},
          {"landmarks_promoted", c.mapper.landmarks_promoted},
          {"landmarks_pruned", c.mapper.landmarks_pruned},
          {"landmarks_evicted", c.mapper.landmarks_evicted},
          {"landmarks_rejected_full", c.mapper.landmarks_rejected_full},
          {"candidates_rejected_full", c.mapper.candidates_rejected_full},
          {"appearances_rejected_full", c.mapper.appearances_rejected_full},
          {"removals_untold", c.removals_untold}};
}

nlohmann::json parameters_json(const Parameters& parameters) {
  nlohmann::json json;
  for (const ParameterInfo& info : parameter_table()) {
    nlohmann::json& value = json[std::string(info.key)];
    std::visit([&](auto field) { value = parameters.*field; }, info.field);
    if (info.may_be_auto && value == 0.0) value = "auto";
  }
  return json;
}

nlohmann::json joint_json(const TeamLog& log, const JointLog& joint) {
  Time start = log.robots[0].frames.front().stamp;
  for (const RobotLog& robot : log.robots) start = std::min(start, robot.frames.front().stamp);
  nlohmann::json joins = nlohmann::json::array();
  for (const JoinLog& join : joint.joins) {
    const Pose2& T = join.T_host_guest;
    joins.push_back({{"host", log.robots[static_cast<std::size_t>(join.host)].name},
                     {"guest", log.robots[static_cast<std::size_t>(join.guest)].name},
                     {"time_s", (join.stamp - start).seconds()},
                     {"x_m", T.x_m},
                     {"y_m", T.y_m},
                     {"theta_rad", T.theta_rad},
                     {"common_landmarks", join.common_landmarks},
                     {"imported_landmarks", join.imported_landmarks}});
  }
  nlohmann::json updates;  // by the number of robots that saw the landmark in one time step
  const auto& counted = joint.counters.updates;
  for (std::size_t k = 1; k <= log.robots.size() && k < counted.size(); ++k) {
    updates[std::to_string(k)] = counted[k];
  }
  return {{"joins", joins},
          {"joins_refused", joint.counters.joins_refused},
          {"landmarks_rejected_full", joint.counters.rejected_full},
          {"updates_by_observers", updates}};
}

std::string summary_text_of(const TeamLog& log, const TeamFigures& figures,
                            const RunDescription& run) {
  nlohmann::json json = figures_json(figures);
  json["zenith"] = ZENITH_VERSION;
  json["seed"] = run.seed;
  json["parameters"] = parameters_json(run.parameters);
  if (!run.alignment.shifts.empty()) {
    json["clocks"] = {{"wall_time", run.alignment.wall},
                      {"notes", run.alignment.notes},
                      {"warnings", run.alignment.warnings}};
  }
  if (log.joint) json["joint"] = joint_json(log, *log.joint);
  for (std::size_t i = 0; i < log.robots.size(); ++i) {
    nlohmann::json& robot = json["robots"][i];
    robot["memory_bytes"] = log.robots[i].memory.total();
    for (const MemoryPart& part : log.robots[i].memory.parts()) {
      robot["memory"].push_back({{"part", part.name}, {"bytes", part.bytes}});
    }
    robot["counters"] = counters_json(log.robots[i].counters);
    robot["corner_sigma_px"] = log.robots[i].corner_sigma_px;
    if (i < run.views.size()) {
      robot["view"] = {{"fov_deg", run.views[i].fov_deg},
                       {"inside_share", run.views[i].inside_share}};
    }
    if (i < run.warnings.size()) robot["warnings"] = run.warnings[i];
    if (i < run.alignment.shifts.size()) robot["clock"] = shift_json(run.alignment.shifts[i]);
    int merges = 0;
    for (const PairFigures& pair : figures.pairs) {
      if (pair.own == static_cast<int>(i)) merges += pair.merges;
    }
    robot["merges"] = merges;
  }
  return json.dump(2) + "\n";
}

}  // namespace

Status write_files(const fs::path& folder, const TeamLog& log, const TeamFigures& figures,
                   const RunDescription& run) {
  for (std::size_t i = 0; i < log.robots.size(); ++i) {
    const RobotLog& robot = log.robots[i];
    const fs::path place = folder / robot.name;
    std::error_code code;
    fs::create_directories(place, code);
    if (code) return Error{place.string() + ": cannot be made: " + code.message()};
    const std::pair<const char*, std::string> files[] = {
        {"trajectory.tum", trajectory_text(robot)},
        {"landmarks.csv", landmarks_text(robot)},
        {"alignments.csv", alignments_text(log, robot)},
        {"confidence.csv", confidence_text(log, i)}};
    for (const auto& [name, text] : files) {
      if (const Status saved = write_file(place / name, text); !saved) return saved;
    }
  }
  return write_file(folder / "summary.json", summary_text_of(log, figures, run));
}

}  // namespace zenith::tools
