#pragma once
// Writing a recording into a new folder. At any moment the folder can be read: a frame is listed
// when its file is complete, and lists hold whole lines (line_file.h). Files are new ones in the
// folder that was made, whatever becomes of its path (new_folder.h).

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "drivers/odometry/can_frame.h"
#include "platform/base/result.h"
#include "platform/linux/clock_reading.h"
#include "platform/linux/new_folder.h"
#include "platform/recording/line_file.h"
#include "platform/recording/robot_file.h"
#include "slam/geometry.h"
#include "slam/image/image.h"
#include "slam/robot.h"

namespace zenith {

class RecordingWriter {
 public:
  // Makes `folder`, which must not exist, and writes the robot's description. The interface's name
  // is one (is_interface_name()).
  static Result<RecordingWriter> create(const std::filesystem::path& folder,
                                        const RobotConfig& config, const RobotFile& robot);

  // Stamps rise.
  Status add_frame(Time stamp, ImageView frame);
  void add_can(const CanFrame& frame);
  void add_truth(Time stamp, const Pose2& T_world_robot);
  void add_estimate(Time stamp, const Pose2& T_start_robot);
  // Monotonic times do not fall. Recordings without any have no clock.csv.
  void add_clock(const ClockReading& reading);

  // The two halves of add_frame(). On any threads: the frame's file; its size in bytes, or nothing
  // is left of it. And, in the order of stamps, that it is complete.
  Result<std::uint64_t> write_frame(Time stamp, ImageView frame, int compression) const;
  void list_frame(Time stamp);
  // Another file of the recording's folder.
  Status add_file(const std::string& name, std::string_view content) const;

  // What was added so far is in its files then.
  Status flush();
  // The same at the end: tells whether everything was written.
  Status finish() { return flush(); }

  // Of all files but the frames.
  std::uint64_t list_bytes() const;

 private:
  RecordingWriter(NewFolder folder, NewFolder camera, NewFolder frames, std::string interface);

  NewFolder folder_;
  NewFolder frames_;
  std::string interface_;
  LineFile frame_list_;
  LineFile can_log_;
  LineFile truth_;
  LineFile estimate_;
  LineFile clock_;
};

}  // namespace zenith
