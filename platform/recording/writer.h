#pragma once
// Writing a recording into a folder. At any moment the folder can be read: a frame is listed when
// its file is complete, and lists hold whole lines (line_file.h).

#include <cstdint>
#include <filesystem>
#include <string>

#include "drivers/odometry/can_frame.h"
#include "platform/base/result.h"
#include "platform/recording/line_file.h"
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
  void add_estimate(Time stamp, const Pose2& T_start_robot);

  // For those who write frames elsewhere, on other threads: where its file belongs, and, in the
  // order of stamps, that it is complete.
  std::filesystem::path frame_path(Time stamp) const;
  void list_frame(Time stamp);

  // What was added so far is in its files then.
  Status flush();
  // The same at the end: tells whether everything was written.
  Status finish() { return flush(); }

  // Of all files but the frames.
  std::uint64_t list_bytes() const;

 private:
  RecordingWriter(std::filesystem::path folder, std::string interface);

  std::filesystem::path folder_;
  std::string interface_;
  LineFile frame_list_;
  LineFile can_log_;
  LineFile truth_;
  LineFile estimate_;
};

}  // namespace zenith
