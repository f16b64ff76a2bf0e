#include "platform/recording/ground_truth.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "platform/recording/seconds.h"

namespace zenith {
namespace {

constexpr std::size_t kMaxPoses = 5'000'000;  // 14 hours, 100 a second
constexpr LineLimits kLimits = {128 * kMaxPoses};

}  // namespace

std::optional<TumLine> parse_tum_line(std::string_view line) {
  std::istringstream words{std::string(line)};
  std::string stamp;
  double v[7];
  if (!(words >> stamp)) return std::nullopt;
  for (double& value : v) {
    if (!(words >> value) || !std::isfinite(value)) return std::nullopt;
  }
  const auto time = parse_seconds(stamp);
  const double norm = std::sqrt(v[3] * v[3] + v[4] * v[4] + v[5] * v[5] + v[6] * v[6]);
  if (!time || std::abs(norm - 1.0) > 0.01) return std::nullopt;
  const double yaw =
      std::atan2(2.0 * (v[6] * v[5] + v[3] * v[4]), 1.0 - 2.0 * (v[4] * v[4] + v[5] * v[5]));
  const double up = 1.0 - 2.0 * (v[3] * v[3] + v[4] * v[4]);
  return TumLine{{*time, {v[0], v[1], yaw}}, std::acos(std::clamp(up, -1.0, 1.0))};
}

Result<std::vector<StampedPose>> parse_tum(InputLines& file) {
  std::vector<StampedPose> poses;
  std::string_view line;
  while (file.next(line)) {
    if (line.find_first_not_of(" \t") == std::string::npos || line[0] == '#') continue;
    const auto parsed = parse_tum_line(line);
    if (!parsed) return file.error("expected 'seconds x y z qx qy qz qw' with a unit quaternion");
    const StampedPose& pose = parsed->pose;
    if (!poses.empty() && pose.stamp <= poses.back().stamp) {
      return file.error("the stamp does not follow the one before");
    }
    if (poses.size() == kMaxPoses) {
      return file.error("expected at most " + std::to_string(kMaxPoses) + " poses");
    }
    poses.push_back(pose);
  }
  if (!file.status()) return file.status().error();
  return poses;
}

Result<std::vector<StampedPose>> read_tum(const std::filesystem::path& path) {
  auto file = InputLines::open(path.string(), kLimits);
  if (!file) return file.error();
  return parse_tum(*file);
}

std::string format_tum(const StampedPose& pose) {
  char text[160];
  std::snprintf(text, sizeof text, "%s %.6f %.6f 0 0 0 %.9f %.9f\n",
                format_seconds(pose.stamp).c_str(), pose.pose.x_m, pose.pose.y_m,
                std::sin(0.5 * pose.pose.theta_rad), std::cos(0.5 * pose.pose.theta_rad));
  return text;
}

std::optional<Pose2> pose_at(const std::vector<StampedPose>& poses, Time stamp) {
  constexpr double kMaxApart_s = 0.5;
  const auto after =
      std::lower_bound(poses.begin(), poses.end(), stamp,
                       [](const StampedPose& pose, Time t) { return pose.stamp < t; });
  if (after == poses.end()) return std::nullopt;
  if (after->stamp == stamp) return after->pose;
  if (after == poses.begin()) return std::nullopt;
  const StampedPose& a = *(after - 1);
  const StampedPose& b = *after;
  const double apart = (b.stamp - a.stamp).seconds();
  if (apart > kMaxApart_s) return std::nullopt;
  const double s = (stamp - a.stamp).seconds() / apart;
  const double turn = wrap_angle(b.pose.theta_rad - a.pose.theta_rad);
  return Pose2{a.pose.x_m + s * (b.pose.x_m - a.pose.x_m),
               a.pose.y_m + s * (b.pose.y_m - a.pose.y_m), wrap_angle(a.pose.theta_rad + s * turn)};
}

}  // namespace zenith
