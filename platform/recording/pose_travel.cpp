#include "platform/recording/pose_travel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "platform/base/printable.h"
#include "platform/recording/travel_file.h"

namespace zenith {
namespace {

constexpr LineLimits kLimits = {256 * kMaxTravelLines};
// Beyond half a turn the other way round would be as likely; this leaves room for noise.
constexpr double kMostTurn_rad = 2.0;
// A floor is flat; a camera's frame lies on its side.
constexpr double kMostLean_rad = 20.0 * std::numbers::pi / 180.0;
// Of stamps and poses: what a step may be longer than the limits allow.
constexpr double kJitter_m = 0.01;
constexpr double kJump_m = 1e5;
// The travel so far is told in whole tenths of a millimetre, as a fine encoder would: what rounding
// left in the poses is then no motion, and standing is standing. It does not add up.
constexpr double kUnitsPerMetre = 1e4;
// Sideways travel is judged over pieces of this much travel or turn: within them rounding cancels.
constexpr double kPiece_m = 0.2;
constexpr double kPiece_rad = 0.3;
constexpr double kMostSideways = 0.1;  // of the travel of the wheels
constexpr double kLeastSideways_m = 0.1;

double on_grid(double travel_m) {
  return std::round(travel_m * kUnitsPerMetre) / kUnitsPerMetre;
}

// Sideways against wheels' travel, piece by piece.
class SidewaysTravel {
 public:
  void add(const ArcTravel& arc, double track_width_m) {
    sideways_m_ += arc.sideways_m;
    driven_m_ += 0.5 * (arc.left_m + arc.right_m);
    turned_rad_ += (arc.right_m - arc.left_m) / track_width_m;
    if (std::abs(driven_m_) < kPiece_m && std::abs(turned_rad_) < kPiece_rad &&
        std::abs(sideways_m_) < kPiece_m) {
      return;
    }
    sum_sideways_m_ += std::abs(sideways_m_);
    sum_wheels_m_ += std::max(std::abs(driven_m_), 0.5 * track_width_m * std::abs(turned_rad_));
    sideways_m_ = driven_m_ = turned_rad_ = 0.0;
  }

  bool too_much() const {
    return sum_sideways_m_ > kLeastSideways_m && sum_sideways_m_ > kMostSideways * sum_wheels_m_;
  }
  std::string text() const {
    char text[320];
    std::snprintf(text, sizeof text,
                  "the poses move sideways by %.2f m while the wheels would roll %.2f m; expected "
                  "poses of base_link, on the floor in the middle between the two wheels, with x "
                  "forward: is it another frame's (camera, laser), or a base that drives sideways?",
                  sum_sideways_m_, sum_wheels_m_);
    return text;
  }

 private:
  double sideways_m_ = 0.0;  // of the piece so far
  double driven_m_ = 0.0;
  double turned_rad_ = 0.0;
  double sum_sideways_m_ = 0.0;
  double sum_wheels_m_ = 0.0;
};

// The travel so far, pose by pose.
class PoseTravel {
 public:
  explicit PoseTravel(const RobotFile& robot)
      : track_width_m_(robot.poses_track_width_m > 0.0 ? robot.poses_track_width_m
                                                       : robot.wheels.track_width_m),
        limits_(robot.odometry.limits),
        decoder_(travel_decoder(robot.odometry)) {}

  Status add(const InputLines& file, const TumLine& line, WheelLog& log) {
    const StampedPose& pose = line.pose;
    if (line.lean_rad > kMostLean_rad) {
      char text[160];
      std::snprintf(text, sizeof text,
                    "the pose leans by %.0f degrees; expected that of base_link, which stands on "
                    "a flat floor: is it the pose of a camera?",
                    line.lean_rad * 180.0 / std::numbers::pi);
      return file.error(text);
    }
    // What does not follow moves nothing: the decoder counts and refuses it.
    if (!last_ || pose.stamp > last_->stamp) {
      if (last_) {
        const Status moved = move(file, pose);
        if (!moved) return moved;
      }
      last_ = pose;
    }
    WheelNews news;
    news.left = WheelReading{.value = on_grid(left_m_)};
    news.right = WheelReading{.value = on_grid(right_m_)};
    if (const auto sample = decoder_.take(pose.stamp, news)) log.samples.push_back(*sample);
    return {};
  }

  const SidewaysTravel& sideways() const { return sideways_; }
  const WheelDecoder& decoder() const { return decoder_; }

 private:
  Status move(const InputLines& file, const StampedPose& pose) {
    const ArcTravel arc = arc_travel(last_->pose, pose.pose, track_width_m_);
    const double turn_rad = wrap_angle(pose.pose.theta_rad - last_->pose.theta_rad);
    const double apart_s = (pose.stamp - last_->stamp).seconds();
    const double chord_m =
        std::hypot(pose.pose.x_m - last_->pose.x_m, pose.pose.y_m - last_->pose.y_m);
    // Farther than the wheels reach: the base put its odometry back, or was put elsewhere. The
    // decoder counts it as a restart: a step that no wheel makes within the limits' ranges.
    const bool jumped =
        !(chord_m <= limits_.max_speed_mps * std::min(apart_s, limits_.max_gap_s) + kJitter_m);
    if (jumped) {
      left_m_ += kJump_m;
      right_m_ += kJump_m;
      return {};
    }
    if (std::abs(turn_rad) > kMostTurn_rad) {
      char text[160];
      std::snprintf(text, sizeof text,
                    "turns by %.0f degrees in %.2f s; expected less than %.0f from one pose to "
                    "the next: which way round it turned cannot be known; record poses more often",
                    std::abs(turn_rad) * 180.0 / std::numbers::pi, apart_s,
                    kMostTurn_rad * 180.0 / std::numbers::pi);
      return file.error(text);
    }
    left_m_ += arc.left_m;
    right_m_ += arc.right_m;
    sideways_.add(arc, track_width_m_);
    return {};
  }

  double track_width_m_;
  WheelLimits limits_;
  WheelDecoder decoder_;
  std::optional<StampedPose> last_;
  double left_m_ = 0.0;
  double right_m_ = 0.0;
  SidewaysTravel sideways_;
};

}  // namespace

ArcTravel arc_travel(const Pose2& from, const Pose2& to, double track_width_m) {
  const double half = 0.5 * wrap_angle(to.theta_rad - from.theta_rad);
  const double heading = from.theta_rad + half;
  const double dx = to.x_m - from.x_m;
  const double dy = to.y_m - from.y_m;
  // The series of h / sin(h) is exact to 1e-16 below.
  const double stretch = std::abs(half) < 1e-3 ? 1.0 + half * half / 6.0 : half / std::sin(half);
  const double way = stretch * (dx * std::cos(heading) + dy * std::sin(heading));
  return {way - track_width_m * half, way + track_width_m * half,
          dy * std::cos(heading) - dx * std::sin(heading)};
}

Result<WheelLog> parse_pose_travel(InputLines& file, const RobotFile& robot) {
  const WheelCodecConfig& config = robot.odometry;
  if (config.swap_wheels || config.invert_left || config.invert_right) {
    return Error{file.name() +
                 ": odometry.swap_wheels, invert_left and invert_right of robot.toml do not apply "
                 "to poses; remove them: the base exchanged its wheels already, or its poses are "
                 "wrong"};
  }
  PoseTravel travel(robot);
  WheelLog log;
  std::string_view line;
  while (file.next(line)) {
    if (line.find_first_not_of(" \t") == std::string_view::npos || line.front() == '#') continue;
    const auto pose = parse_tum_line(line);
    if (!pose) {
      if (log.malformed++ == 0) {
        log.first_malformed = file.place() +
                              ": expected 'seconds x y z qx qy qz qw' with a unit quaternion, "
                              "found '" +
                              printable_start(line, 80) + "'";
      }
      continue;
    }
    if (log.samples.size() == kMaxTravelLines) {
      return file.error("expected at most " + std::to_string(kMaxTravelLines) +
                        " poses; record a long drive in parts");
    }
    if (const Status added = travel.add(file, *pose, log); !added) return added.error();
  }
  if (!file.status()) return file.status().error();
  if (travel.sideways().too_much()) {
    return Error{file.name() + ": " + travel.sideways().text()};
  }
  log.decoder = travel.decoder().counters();
  log.fault = travel.decoder().fault();
  return check_log(std::move(log), file.name());
}

Result<WheelLog> read_pose_travel(const std::filesystem::path& path, const RobotFile& robot) {
  auto file = InputLines::open(path.string(), kLimits);
  if (!file) return file.error();
  return parse_pose_travel(*file, robot);
}

}  // namespace zenith
