#include "platform/recording/writer.h"

#include <sys/stat.h>
#include <unistd.h>

#include <utility>

#include "platform/recording/candump.h"
#include "platform/recording/clock_log.h"
#include "platform/recording/ground_truth.h"
#include "platform/recording/layout.h"
#include "platform/recording/png.h"
#include "platform/recording/sensor_file.h"

namespace zenith {
namespace {

std::string frame_name(Time stamp) {
  return std::to_string(stamp.ns) + ".png";
}

LineFile new_list(const NewFolder& folder, const std::filesystem::path& path) {
  return {folder.create_file(path.filename().string()), path};
}

void add_pose(const NewFolder& folder, const std::filesystem::path& path, LineFile& file,
              const StampedPose& pose) {
  if (!file.is_open()) {
    file = new_list(folder, path);
    file.add("# timestamp x y z qx qy qz qw\n");
  }
  file.add(format_tum(pose));
}

// One step after the other: each of them is new.
Result<NewFolder> make_folders(const NewFolder& folder, const std::filesystem::path& within) {
  const std::string below = within.lexically_relative(folder.path()).begin()->string();
  auto made = folder.make_folder(below);
  if (!made || made->path() == within) return made;
  return make_folders(*made, within);
}

}  // namespace

RecordingWriter::RecordingWriter(NewFolder folder, NewFolder camera, NewFolder frames,
                                 std::string interface)
    : folder_(std::move(folder)),
      frames_(std::move(frames)),
      interface_(std::move(interface)),
      frame_list_(new_list(camera, layout::frame_list(folder_.path()))),
      can_log_(new_list(folder_, layout::can_log(folder_.path(), interface_))) {
  frame_list_.add("#timestamp [ns],filename\n");
}

Result<RecordingWriter> RecordingWriter::create(const std::filesystem::path& folder,
                                                const RobotConfig& config, const RobotFile& robot) {
  auto made = NewFolder::make(folder);
  if (!made) return made.error();
  auto camera = make_folders(*made, layout::camera(folder));
  if (!camera) return camera.error();
  auto frames = make_folders(*camera, layout::frames(folder));
  if (!frames) return frames.error();
  RobotFile described = robot;
  described.wheels = config.wheels;
  const SensorFile sensor{config.lens, config.mount, config.frame_rate_hz};
  const auto write = [](const NewFolder& where, const std::filesystem::path& path,
                        const std::string& text) {
    return where.write_file(path.filename().string(), text);
  };
  Status written = write(*made, layout::robot(folder), format_robot_file(described));
  if (written) written = write(*camera, layout::sensor(folder), format_sensor_file(sensor));
  if (!written) return written.error();
  return RecordingWriter(std::move(*made), std::move(*camera), std::move(*frames),
                         robot.can_interface);
}

Result<std::uint64_t> RecordingWriter::write_frame(Time stamp, ImageView frame,
                                                   int compression) const {
  const std::string name = frame_name(stamp);
  auto file = frames_.create_file(name);
  if (!file) return file.error();
  const UniqueFd same(::dup(file->get()));
  const Status written =
      write_grey_png(std::move(*file), frames_.path() / name, frame, compression);
  if (!written) {
    frames_.remove_file(name);
    return written.error();
  }
  struct stat info = {};
  return ::fstat(same.get(), &info) == 0 ? static_cast<std::uint64_t>(info.st_size) : 0;
}

void RecordingWriter::list_frame(Time stamp) {
  frame_list_.add(std::to_string(stamp.ns) + ',' + frame_name(stamp) + '\n');
}

Status RecordingWriter::add_frame(Time stamp, ImageView frame) {
  constexpr int kQuick = 1;
  const auto written = write_frame(stamp, frame, kQuick);
  if (!written) return written.error();
  list_frame(stamp);
  return {};
}

Status RecordingWriter::add_file(const std::string& name, std::string_view content) const {
  return folder_.write_file(name, content);
}

void RecordingWriter::add_can(const CanFrame& frame) {
  can_log_.add(format_candump(frame, interface_) + '\n');
}

void RecordingWriter::add_truth(Time stamp, const Pose2& T_world_robot) {
  add_pose(folder_, layout::ground_truth(folder_.path()), truth_, {stamp, T_world_robot});
}

void RecordingWriter::add_estimate(Time stamp, const Pose2& T_start_robot) {
  add_pose(folder_, layout::estimate(folder_.path()), estimate_, {stamp, T_start_robot});
}

void RecordingWriter::add_clock(const ClockReading& reading) {
  if (!clock_.is_open()) {
    clock_ = new_list(folder_, layout::clocks(folder_.path()));
    clock_.add(kClockLogHeader);
  }
  clock_.add(format_clock_reading(reading));
}

Status RecordingWriter::flush() {
  Status status;
  for (LineFile* file : {&can_log_, &truth_, &estimate_, &clock_, &frame_list_}) {
    const bool used = file->bytes() > 0 || file == &can_log_ || file == &frame_list_;
    if (!used) continue;
    const Status flushed = file->flush();
    if (status && !flushed) status = flushed;
  }
  return status;
}

std::uint64_t RecordingWriter::list_bytes() const {
  return frame_list_.bytes() + can_log_.bytes() + truth_.bytes() + estimate_.bytes() +
         clock_.bytes();
}

}  // namespace zenith
