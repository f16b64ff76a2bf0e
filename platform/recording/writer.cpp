#include "platform/recording/writer.h"

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

}  // namespace

RecordingWriter::RecordingWriter(std::filesystem::path folder, std::string interface)
    : folder_(std::move(folder)),
      interface_(std::move(interface)),
      frame_list_(layout::frame_list(folder_)),
      can_log_(layout::can_log(folder_, interface_)) {
  frame_list_ << "#timestamp [ns],filename\n";
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

Status RecordingWriter::add_frame(Time stamp, ImageView frame) {
  const std::string name = std::to_string(stamp.ns) + ".png";
  frame_list_ << stamp.ns << ',' << name << '\n';
  return write_grey_png(layout::frames(folder_) / name, frame);
}

void RecordingWriter::add_can(const CanFrame& frame) {
  can_log_ << format_candump(frame, interface_) << '\n';
}

void RecordingWriter::add_truth(Time stamp, const Pose2& T_world_robot) {
  if (!truth_.is_open()) {
    truth_.open(layout::ground_truth(folder_));
    truth_ << "# timestamp x y z qx qy qz qw\n";
  }
  truth_ << format_tum({stamp, T_world_robot});
}

Status RecordingWriter::finish() {
  frame_list_.close();
  can_log_.close();
  if (truth_.is_open()) truth_.close();
  if (frame_list_ && can_log_ && truth_) return {};
  return Error{folder_.string() + ": cannot be written whole: is the disk full?"};
}

}  // namespace zenith
