#pragma once
// Where the wheels of a recording come from: exactly one of
//
//   <can_interface>.log   the base's CAN bus (can_log.h), read by the codec that robot.toml names
//   odometry.csv          the total travel of both wheels (travel_file.h)
//   odometry.tum          the poses that the base made of it (pose_travel.h)

#include <filesystem>
#include <string>

#include "platform/base/result.h"
#include "platform/recording/robot_file.h"
#include "platform/recording/wheel_log.h"

namespace zenith {

enum class OdometryFormat { kCanLog, kTravel, kPoses };

struct OdometryFile {
  OdometryFormat format = OdometryFormat::kCanLog;
  std::filesystem::path path;
};

// None and several are errors; of several it says which to remove.
Result<OdometryFile> find_odometry(const std::filesystem::path& folder,
                                   const std::string& can_interface);

// Whatever the file, a log with at least one sample, and the same counters. Reads once more what
// `file` names; `robot` is that of the same folder.
Result<WheelLog> read_odometry(const OdometryFile& file, const RobotFile& robot);

}  // namespace zenith
