#pragma once
// Where things stand in a recording's folder.

#include <filesystem>
#include <string>

namespace zenith::layout {

using std::filesystem::path;

inline path robot(const path& folder) {
  return folder / "robot.toml";
}
inline path camera(const path& folder) {
  return folder / "mav0" / "cam0";
}
inline path sensor(const path& folder) {
  return camera(folder) / "sensor.yaml";
}
inline path frame_list(const path& folder) {
  return camera(folder) / "data.csv";
}
inline path frames(const path& folder) {
  return camera(folder) / "data";
}
inline path can_log(const path& folder, const std::string& interface) {
  return folder / (interface + ".log");
}
// In place of a CAN log: the wheels' travel, or the poses that the base itself made of it.
inline path odometry_csv(const path& folder) {
  return folder / "odometry.csv";
}
inline path odometry_tum(const path& folder) {
  return folder / "odometry.tum";
}
// How the clock of the stamps lay against the wall clock; recordings may have none.
inline path clocks(const path& folder) {
  return folder / "clock.csv";
}
// What the running robot itself thought, when it was recorded; not used by a replay.
inline path estimate(const path& folder) {
  return folder / "estimate.tum";
}
inline path ground_truth(const path& folder) {
  return folder / "groundtruth.tum";
}

}  // namespace zenith::layout
