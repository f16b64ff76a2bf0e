#include "platform/recording/writer.h"

#include <fstream>
#include <utility>

#include "platform/recording/candump.h"
#include "platform/recording/ground_truth.h"
#include "platform/recording/layout.h"
#include "platform/recording/png.h"
#include "platform/recording/sensor_file.h"

namespace zenith {
namespace {

Status write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) return Error{path.string() + ": cannot be written"};
  return {};
}

std::string frame_name(Time stamp) {
  return std::to_string(stamp.ns) + ".png";
}

void add_pose(const std::filesystem::path& path, LineFile& file, const StampedPose& pose) {
  if (!file.is_open()) {
    file = LineFile(path);
    file.add("# timestamp x y z qx qy qz qw\n");
  }
  file.add(format_tum(pose));
}

}  // namespace

RecordingWriter::RecordingWriter(std::filesystem::path folder, std::string interface)
    : folder_(std::move(folder)),
      interface_(std::move(interface)),
      frame_list_(layout::frame_list(folder_)),
      can_log_(layout::can_log(folder_, interface_)) {
  frame_list_.add("#timestamp [ns],filename\n");
}

Result<RecordingWriter> RecordingWriter::create(const std::filesystem::path& folder,
                                                const RobotConfig& config, const RobotFile& robot) {
  std::error_code code;
  std::filesystem::create_directories(layout::frames(folder), code);
  if (code) return Error{layout::frames(folder).string() + ": cannot be made: " + code.message()};
  RobotFile described = robot;
  described.wheels = config.wheels;
  const SensorFile sensor{config.lens, config.mount, config.frame_rate_hz};
  Status written = write_text(layout::robot(folder), format_robot_file(described));
  if (written) written = write_text(layout::sensor(folder), format_sensor_file(sensor));
  if (!written) return written.error();
  return RecordingWriter(folder, robot.can_interface);
}

std::filesystem::path RecordingWriter::frame_path(Time stamp) const {
  return layout::frames(folder_) / frame_name(stamp);
}

void RecordingWriter::list_frame(Time stamp) {
  frame_list_.add(std::to_string(stamp.ns) + ',' + frame_name(stamp) + '\n');
}

Status RecordingWriter::add_frame(Time stamp, ImageView frame) {
  const Status written = write_grey_png(frame_path(stamp), frame);
  if (written) list_frame(stamp);
  return written;
}

void RecordingWriter::add_can(const CanFrame& frame) {
  can_log_.add(format_candump(frame, interface_) + '\n');
}

void RecordingWriter::add_truth(Time stamp, const Pose2& T_world_robot) {
  add_pose(layout::ground_truth(folder_), truth_, {stamp, T_world_robot});
}

void RecordingWriter::add_estimate(Time stamp, const Pose2& T_start_robot) {
  add_pose(layout::estimate(folder_), estimate_, {stamp, T_start_robot});
}

Status RecordingWriter::flush() {
  Status status;
  for (LineFile* file : {&can_log_, &truth_, &estimate_, &frame_list_}) {
    const bool used = file->bytes() > 0 || file == &can_log_ || file == &frame_list_;
    if (!used) continue;
    const Status flushed = file->flush();
    if (status && !flushed) status = flushed;
  }
  return status;
}

std::uint64_t RecordingWriter::list_bytes() const {
  return frame_list_.bytes() + can_log_.bytes() + truth_.bytes() + estimate_.bytes();
}

}  // namespace zenith
