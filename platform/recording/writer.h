#pragma once
// Writing a recording into a folder that the caller keeps atomic (tools/atomic_output.h).

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "drivers/odometry/can_frame.h"
#include "platform/base/result.h"
#include "platform/recording/robot_file.h"
#include "slam/geometry.h"
#include "slam/image/image.h"
#include "slam/robot.h"

namespace zenith {

class RecordingWriter {
 public:
  // Makes `folder` and writes the robot's description.
  static Result<RecordingWriter> create(const std::filesystem::path& folder,
                                        const RobotConfig& config, const RobotFile& robot);

  // Stamps rise.
  Status add_frame(Time stamp, ImageView frame);
  void add_can(const CanFrame& frame);
  void add_truth(Time stamp, const Pose2& T_world_robot);

  // Closes all files and tells whether everything was written.
  Status finish();

 private:
  RecordingWriter(std::filesystem::path folder, std::string interface);

  std::filesystem::path folder_;
  std::string interface_;
  std::ofstream frame_list_;
  std::ofstream can_log_;
  std::ofstream truth_;
};

}  // namespace zenith
