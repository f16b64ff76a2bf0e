#pragma once
// A play: a part of a recording as the emulated boards play it, made on the host by hil-cut so that
// nothing is decoded under emulation. Times are nanoseconds since the play's first CAN frame,
// already slowed. Files of the folder:
//
//   frames.grey        the pictures one after the other, width * height bytes each
//   frames.txt         "width height count", then each picture's time
//   can0.log           candump -L lines for canplayer; its first one is the play's beginning
//   standing.log       the last CAN frame for a second more: a robot that stands
//   truth.txt          time x y theta: the true pose, seen from where the first picture was taken
//   start.txt          x y theta of that place in the building
//   description.toml   lens, mount and wheels, for zenith.toml
//   rate.txt           pictures a second

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/base/time.h"
#include "slam/geometry.h"

namespace zenith::hil {

struct TruePose {
  std::int64_t time_ns = 0;
  Pose2 T_start_robot;
};

// Times rise.
inline Result<std::vector<TruePose>> read_truth(const std::string& folder) {
  std::ifstream in(folder + "/truth.txt");
  std::vector<TruePose> poses;
  TruePose pose;
  while (in >> pose.time_ns >> pose.T_start_robot.x_m >> pose.T_start_robot.y_m >>
         pose.T_start_robot.theta_rad) {
    poses.push_back(pose);
  }
  if (!in.eof() || poses.empty()) {
    return Error{folder + "/truth.txt: expected lines 'ns x y theta'; hil-cut writes them"};
  }
  return poses;
}

inline Result<Pose2> read_start(const std::string& folder) {
  std::ifstream in(folder + "/start.txt");
  Pose2 pose;
  if (in >> pose.x_m >> pose.y_m >> pose.theta_rad) return pose;
  return Error{folder + "/start.txt: expected 'x y theta'; hil-cut writes them"};
}

// Interpolated; the first or last one outside. `poses` is not empty.
inline Pose2 truth_at(const std::vector<TruePose>& poses, std::int64_t time_ns) {
  if (time_ns <= poses.front().time_ns) return poses.front().T_start_robot;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const TruePose& a = poses[i - 1];
    const TruePose& b = poses[i];
    if (b.time_ns < time_ns) continue;
    const double s =
        static_cast<double>(time_ns - a.time_ns) / static_cast<double>(b.time_ns - a.time_ns);
    const Pose2& p = a.T_start_robot;
    const Pose2& q = b.T_start_robot;
    return {p.x_m + s * (q.x_m - p.x_m), p.y_m + s * (q.y_m - p.y_m),
            wrap_angle(p.theta_rad + s * wrap_angle(q.theta_rad - p.theta_rad))};
  }
  return poses.back().T_start_robot;
}

}  // namespace zenith::hil
