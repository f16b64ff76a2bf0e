#include "platform/recording/odometry_file.h"

#include <algorithm>
#include <vector>

#include "platform/base/printable.h"
#include "platform/recording/layout.h"
#include "platform/recording/pose_travel.h"
#include "platform/recording/travel_file.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;

// Other logs of the folder, such as candump-2026-12-01_093000.log, in alphabetical order.
std::string other_logs(const fs::path& folder) {
  constexpr std::size_t kMost = 4;
  std::vector<std::string> names;
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) {
    if (it->path().extension() == ".log") names.push_back(it->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  if (names.size() > kMost) names.resize(kMost);
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + printable(name);
  return text;
}

Error no_file(const fs::path& log, const std::string& can_interface) {
  const std::string found = other_logs(log.parent_path());
  return {log.string() + ": missing: expected the wheels of the recording there (candump -L " +
          can_interface + "), or in odometry.csv or odometry.tum beside it" +
          (found.empty()
               ? ""
               : "; found " + found + ": rename the log, or correct odometry.can_interface")};
}

}  // namespace

Result<OdometryFile> find_odometry(const fs::path& folder, const std::string& can_interface) {
  const OdometryFile known[] = {
      {OdometryFormat::kCanLog, layout::can_log(folder, can_interface)},
      {OdometryFormat::kTravel, layout::odometry_csv(folder)},
      {OdometryFormat::kPoses, layout::odometry_tum(folder)},
  };
  std::vector<OdometryFile> found;
  std::error_code code;
  for (const OdometryFile& file : known) {
    if (fs::exists(file.path, code)) found.push_back(file);
  }
  if (found.empty()) return no_file(known[0].path, can_interface);
  if (found.size() == 1) return found.front();
  std::string names;
  std::string remove;
  for (const OdometryFile& file : found) {
    const std::string name = file.path.filename().string();
    const bool first = &file == &found.front();
    names += (first ? "" : &file == &found.back() ? " and " : ", ") + name;
    if (!first) remove += (remove.empty() ? "" : " and ") + name;
  }
  return Error{folder.string() + ": " + names +
               " all hold the wheels of this recording, expected one of them; remove " + remove +
               " to use " + found.front().path.filename().string() +
               ", which is the nearest to the wheels, or remove that one"};
}

Result<WheelLog> read_odometry(const OdometryFile& file, const RobotFile& robot) {
  switch (file.format) {
    case OdometryFormat::kTravel:
      return read_travel_file(file.path, robot.odometry);
    case OdometryFormat::kPoses:
      return read_pose_travel(file.path, robot);
    case OdometryFormat::kCanLog:
      break;
  }
  const auto decoder = make_wheel_decoder(robot.odometry);
  if (!decoder.ok()) {
    return Error{layout::robot(file.path.parent_path()).string() + ": " + decoder.error().message};
  }
  return read_wheel_log(file.path, robot.can_interface, *decoder, robot.log_start());
}

}  // namespace zenith
