#include "tools/replay_judgement.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "platform/linux/input_file.h"
#include "platform/recording/ground_truth.h"
#include "platform/recording/recording.h"
#include "platform/recording/seconds.h"
#include "tools/clocks/shift_json.h"
#include "tools/clocks/shifted_source.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;

constexpr LineLimits kAlignmentLimits = {std::uint64_t{256} << 20U};
constexpr std::uint64_t kMaxSummaryBytes = std::uint64_t{1} << 20U;

// A row of alignments.csv.
struct AlignmentRow {
  Time stamp;
  std::string peer;
  PeerLog view;
};

std::optional<AlignmentRow> parse_alignment(const std::string& line) {
  AlignmentRow row;
  char stamp[32];
  char peer[128];
  char state[16];
  PeerLog& view = row.view;
  Pose2& T = view.T_own_peer;
  const int read =
      std::sscanf(line.c_str(), "%31[^,],%127[^,],%15[^,],%lf,%lf,%lf,%lf,%lf,%lf,%lf,%d", stamp,
                  peer, state, &T.x_m, &T.y_m, &T.theta_rad, &view.variance.x(), &view.variance.y(),
                  &view.variance.z(), &view.confidence, &view.correspondences);
  const auto time = read == 11 ? parse_seconds(stamp) : std::nullopt;
  if (!time) return std::nullopt;
  row.stamp = *time;
  row.peer = peer;
  const std::string name = state;
  if (name == "merged") {
    view.state = AlignmentState::kMerged;
  } else if (name == "withdrawn") {
    view.state = AlignmentState::kWithdrawn;
  } else if (name != "candidate") {
    return std::nullopt;
  }
  return row;
}

Result<std::vector<AlignmentRow>> read_alignments(const fs::path& path) {
  auto file = InputLines::open(path.string(), kAlignmentLimits);
  if (!file.ok()) return file.error();
  std::vector<AlignmentRow> rows;
  std::string_view line;
  while (file->next(line)) {
    if (file->number() == 1 || line.empty()) continue;
    auto row = parse_alignment(std::string(line));
    if (!row) return file->error("expected time_s,peer,state,x_m,y_m,...");
    rows.push_back(std::move(*row));
  }
  if (!file->status()) return file->status().error();
  return rows;
}

// Every row holds until the next one about the same peer.
void spread_alignments(const std::vector<AlignmentRow>& rows,
                       const std::map<std::string, int>& team, RobotLog& robot) {
  for (const auto& [name, peer] : team) {
    std::size_t frame = 0;
    std::optional<PeerLog> current;
    const auto fill_until = [&](Time stamp) {
      for (; frame < robot.frames.size() && robot.frames[frame].stamp < stamp; ++frame) {
        if (current) robot.frames[frame].peers.push_back(*current);
      }
    };
    for (const AlignmentRow& row : rows) {
      if (row.peer != name) continue;
      fill_until(row.stamp);
      current = row.view;
      current->peer = peer;
    }
    if (!robot.frames.empty()) fill_until(robot.frames.back().stamp + Duration{1});
  }
}

// What was added to the recordings' stamps, by robot. Of a damaged summary, which is told later:
// none.
using Clocks = std::map<std::string, ClockShift>;

Clocks clocks_of(const std::string& summary) {
  Clocks clocks;
  try {
    const nlohmann::json whole = nlohmann::json::parse(summary);
    for (const nlohmann::json& robot : whole.at("robots")) {
      clocks.emplace(robot.at("name").get<std::string>(), shift_of_json(robot));
    }
  } catch (const nlohmann::json::exception&) {
    return {};
  }
  return clocks;
}

// Wheels and truth of the recording, at the stamps of the estimated trajectory.
Status fill_frames(Source& recording, const fs::path& folder,
                   const std::vector<StampedPose>& estimate, RobotLog& robot) {
  WheelMotion wheels;
  wheels.build(recording.config().wheels, {});
  Pose2 odometry;
  SourceFrame frame;
  std::size_t next = 0;
  for (auto more = recording.next(frame);; more = recording.next(frame)) {
    if (!more.ok()) return more.error();
    if (!*more) break;
    FrameLog log;
    log.stamp = frame.stamp;
    for (const WheelSample& sample : frame.wheels) wheels.add(sample);
    odometry = odometry * wheels.advance(frame.stamp).motion.mean;
    log.odometry = odometry;
    log.truth = frame.truth;
    while (next < estimate.size() && estimate[next].stamp < frame.stamp) ++next;
    if (next == estimate.size()) break;
    if (estimate[next].stamp != frame.stamp) continue;
    log.T_start_robot = estimate[next].pose;
    robot.frames.push_back(std::move(log));
  }
  if (!robot.frames.empty()) return {};
  return Error{folder.string() + ": no frame has the stamp of an estimated pose"};
}

Result<RobotLog> read_robot(const fs::path& output, const fs::path& folder,
                            const std::map<std::string, int>& team, const Clocks& clocks) {
  ReadOptions options;
  options.pixels = false;
  auto recording = Recording::open(folder, options);
  if (!recording.ok()) return recording.error();
  RobotLog robot;
  robot.name = (*recording)->name();
  const fs::path place = output / robot.name;
  const auto estimate = read_tum(place / "trajectory.tum");
  if (!estimate.ok()) return estimate.error();
  const auto clock = clocks.find(robot.name);
  ShiftedSource shifted(std::move(*recording),
                        clock == clocks.end() ? ClockShift() : clock->second);
  if (const Status filled = fill_frames(shifted, folder, *estimate, robot); !filled) {
    return filled.error();
  }
  const auto rows = read_alignments(place / "alignments.csv");
  if (!rows.ok()) return rows.error();
  spread_alignments(*rows, team, robot);
  robot.correspondences.resize(team.size());
  return robot;
}

// What the text files do not hold.
void complete(const nlohmann::json& summary, TeamFigures& figures) {
  for (RobotFigures& robot : figures.robots) {
    for (const nlohmann::json& entry : summary.at("robots")) {
      if (entry.at("name") != robot.name) continue;
      const nlohmann::json& step = entry.at("step_ms");
      robot.step = {step.at("median"), step.at("p95"), step.at("max")};
      robot.landmarks = entry.at("landmarks");
    }
  }
  for (PairFigures& pair : figures.pairs) {
    for (const nlohmann::json& entry : summary.at("pairs")) {
      if (entry.at("robot") != figures.robots[static_cast<std::size_t>(pair.own)].name) continue;
      if (entry.at("peer") != figures.robots[static_cast<std::size_t>(pair.peer)].name) continue;
      pair.fused = entry.at("fused_landmarks");
      pair.duplicates = entry.at("duplicates");
    }
  }
}

}  // namespace

Result<TeamFigures> judge_output(const fs::path& output, const std::vector<fs::path>& recordings) {
  std::map<std::string, int> team;
  for (const fs::path& folder : recordings) {
    const fs::path plain = fs::absolute(folder / ".").lexically_normal().parent_path();
    team.emplace(plain.filename().string(), static_cast<int>(team.size()));
  }
  if (team.size() != recordings.size()) return Error{"two recordings have the same name"};
  const fs::path summary = output / "summary.json";
  const auto text = read_input(summary.string(), kMaxSummaryBytes);
  TeamLog log;
  for (const fs::path& folder : recordings) {
    auto robot = read_robot(output, folder, team, text.ok() ? clocks_of(*text) : Clocks());
    if (!robot.ok()) return robot.error();
    log.robots.push_back(std::move(*robot));
  }
  TeamFigures figures = judge(log);
  if (!text.ok()) return text.error();
  try {
    complete(nlohmann::json::parse(*text), figures);
  } catch (const nlohmann::json::exception& error) {
    return Error{summary.string() + ": missing or damaged: " + error.what()};
  }
  return figures;
}

}  // namespace zenith::tools
