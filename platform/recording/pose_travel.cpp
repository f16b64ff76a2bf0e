#include "platform/recording/pose_travel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

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

// Poses rarer than this are filled, up to those that are too rare to say what lay between them.
constexpr double kRare_s = 0.06;
constexpr double kTooRare_s = 0.25;
constexpr double kFilled_s = 0.025;
constexpr std::size_t kMostFilled = kMaxTravelLines / 10;

// Steffen, "A simple method for monotonic interpolation in one dimension", A&A 1990, eq. 11: the
// speed at a sample, from the mean speeds before and behind it. Exact while the acceleration is
// constant; 0 where the wheel turns back or begins to stand.
double speed_at(double before_s, double before_mps, double behind_s, double behind_mps) {
  if (!(before_mps * behind_mps > 0.0)) return 0.0;
  const double parabola_mps =
      (before_mps * behind_s + behind_mps * before_s) / (before_s + behind_s);
  const double size_mps =
      std::min({2.0 * std::abs(before_mps), 2.0 * std::abs(behind_mps), std::abs(parabola_mps)});
  return std::copysign(size_mps, before_mps);
}

// One wheel between samples i and i + 1: a cubic with the speeds of speed_at() at both.
class WheelBetween {
 public:
  WheelBetween(const std::vector<WheelSample>& samples, std::size_t i, double WheelSample::*travel)
      : from_m_(samples[i].*travel), way_m_(samples[i + 1].*travel - from_m_) {
    const auto mean = [&](std::size_t k) {
      const double s = (samples[k + 1].stamp - samples[k].stamp).seconds();
      return std::pair{s, (samples[k + 1].*travel - samples[k].*travel) / s};
    };
    const auto [s, mps] = mean(i);
    duration_s_ = s;
    first_mps_ = last_mps_ = mps;
    if (i > 0) {
      const auto [before_s, before_mps] = mean(i - 1);
      first_mps_ = speed_at(before_s, before_mps, s, mps);
    }
    if (i + 2 < samples.size()) {
      const auto [behind_s, behind_mps] = mean(i + 1);
      last_mps_ = speed_at(s, mps, behind_s, behind_mps);
    }
  }

  // `part` of the time.
  double at(double part) const {
    const double bend_m = (1.0 - part) * (first_mps_ * duration_s_ - way_m_) +
                          part * (way_m_ - last_mps_ * duration_s_);
    return from_m_ + part * way_m_ + part * (1.0 - part) * bend_m;
  }

 private:
  double from_m_;
  double way_m_;
  double duration_s_ = 0.0;
  double first_mps_ = 0.0;
  double last_mps_ = 0.0;
};

// Samples between those that lie far apart: between poses at 10 Hz a wheel that speeds up by
// 1 m/s^2 is 1.2 mm away from where an even speed would have it.
std::vector<WheelSample> filled(const std::vector<WheelSample>& samples) {
  std::vector<WheelSample> out;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    out.push_back(samples[i]);
    if (i + 1 == samples.size()) break;
    const Duration apart = samples[i + 1].stamp - samples[i].stamp;
    if (apart.seconds() < kRare_s || apart.seconds() > kTooRare_s) continue;
    const WheelBetween left(samples, i, &WheelSample::left_m);
    const WheelBetween right(samples, i, &WheelSample::right_m);
    const auto pieces = static_cast<int>(std::ceil(apart.seconds() / kFilled_s));
    for (int k = 1; k < pieces; ++k) {
      const double part = static_cast<double>(k) / pieces;
      out.push_back({samples[i].stamp + Duration::from_seconds(part * apart.seconds()),
                     left.at(part), right.at(part)});
    }
  }
  return out;
}

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
      char text[200];
      std::snprintf(text, sizeof text,
                    "the pose leans by %.0f degrees; expected that of base_link, which stands on "
                    "a flat floor: is it the pose of a camera, or is qw written first?",
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
  if (log.samples.size() <= kMostFilled) log.samples = filled(log.samples);
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
