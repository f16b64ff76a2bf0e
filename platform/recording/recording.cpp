#include "platform/recording/recording.h"

#include <algorithm>
#include <cstdio>

#include "platform/base/printable.h"
#include "platform/recording/layout.h"
#include "platform/recording/odometry_file.h"
#include "platform/recording/png.h"
#include "platform/recording/sensor_file.h"

namespace zenith {
namespace fs = std::filesystem;

namespace {

// Wheels that tell of less than most of the frames' time; empty when they tell of enough.
std::string describe_share(const std::vector<WheelSample>& samples,
                           const std::vector<ListedFrame>& frames) {
  constexpr double kLeast = 0.9;
  const double whole_s = (frames.back().stamp - frames.front().stamp).seconds();
  const double common_s = (std::min(samples.back().stamp, frames.back().stamp) -
                           std::max(samples.front().stamp, frames.front().stamp))
                              .seconds();
  if (common_s >= kLeast * whole_s) return {};
  char text[160];
  std::snprintf(
      text, sizeof text,
      ": odometry and frames share %.1f s of the frames' %.1f s (%.0f %%), expected 90 %% "
      "or more: are both stamped by one clock?",
      common_s, whole_s, 100.0 * common_s / whole_s);
  return text;
}

}  // namespace

std::string Recording::name_of(const fs::path& folder) {
  const fs::path plain = fs::absolute(folder).lexically_normal();
  return (plain.has_filename() ? plain : plain.parent_path()).filename().string();
}

Result<std::unique_ptr<Recording>> Recording::open(const fs::path& folder,
                                                   const ReadOptions& options) {
  std::error_code code;
  if (!fs::is_directory(folder, code)) return Error{folder.string() + ": no such folder"};
  std::unique_ptr<Recording> recording(new Recording);
  recording->folder_ = folder;
  recording->name_ = name_of(folder);
  if (!is_printable(recording->name_)) {
    return Error{folder.string() +
                 ": expected a folder's name of printable UTF-8, for it names the robot"};
  }
  recording->options_ = options;
  if (const Status loaded = recording->load_description(); !loaded) return loaded.error();
  return recording;
}

Status Recording::load_description() {
  // Both files describe the robot: tell what is wrong with either at once.
  const auto robot = read_robot_file(layout::robot(folder_));
  const auto sensor = read_sensor_file(layout::sensor(folder_));
  if (!robot.ok() || !sensor.ok()) {
    std::string message = robot.ok() ? "" : robot.error().message;
    if (!sensor.ok()) message += (message.empty() ? "" : "\n") + sensor.error().message;
    return Error{message};
  }
  config_.lens = sensor->lens;
  config_.mount = sensor->mount;
  config_.frame_rate_hz = sensor->frame_rate_hz;
  config_.wheels = robot->wheels;
  auto frames = read_frame_list(layout::frame_list(folder_));
  if (!frames.ok()) return frames.error();
  frames_ = std::move(*frames);
  if (const Status checked = check_files(); !checked) return checked;
  std::error_code code;
  if (fs::exists(layout::ground_truth(folder_), code)) {
    auto truth = read_tum(layout::ground_truth(folder_));
    if (!truth.ok()) return truth.error();
    truth_ = std::move(*truth);
  }
  if (fs::exists(layout::clocks(folder_), code)) {
    auto clock = read_clock_log(layout::clocks(folder_));
    if (!clock.ok()) return clock.error();
    clock_ = std::move(*clock);
  }
  return load_odometry(*robot);
}

Status Recording::check_files() {
  if (options_.skip_damaged || !options_.pixels) return {};
  std::size_t missing = 0;
  std::string first;
  std::error_code code;
  for (const ListedFrame& frame : frames_) {
    if (fs::is_regular_file(layout::frames(folder_) / frame.filename, code)) continue;
    if (missing++ == 0) {
      first = layout::frame_list(folder_).string() + ":" + std::to_string(frame.line) +
              ": the frame " + (layout::frames(folder_) / frame.filename).string() + " is missing";
    }
  }
  if (missing == 0) return {};
  return Error{first + (missing > 1 ? ", and " + std::to_string(missing - 1) + " more" : "") +
               "; --skip-damaged goes on without"};
}

Status Recording::load_odometry(const RobotFile& robot) {
  const auto file = find_odometry(folder_, robot.can_interface);
  if (!file.ok()) return file.error();
  auto log = read_odometry(*file, robot);
  if (!log.ok()) return log.error();
  const fs::path& path = file->path;
  if (const Status moved = move_wheels(log->samples, path); !moved) return moved;
  const auto gaps = describe_gaps(*log, frames_, path, options_.max_odometry_gap_s);
  if (!gaps.ok()) return gaps.error();
  warnings_ = describe_log(*log, path);
  warnings_.insert(warnings_.end(), gaps->begin(), gaps->end());
  if (auto share = describe_share(log->samples, frames_); !share.empty()) {
    warnings_.push_back(path.string() + share);
  }
  for (const WheelSample& sample : log->samples) wheels_.push(sample);
  return {};
}

Status Recording::move_wheels(std::vector<WheelSample>& samples, const fs::path& path) {
  wheels_moved_ = options_.wheels_from_first_frame ? samples.front().stamp - frames_.front().stamp
                                                   : options_.wheels_late;
  if (wheels_moved_ == Duration{}) return {};
  for (WheelSample& sample : samples) {
    if (__builtin_sub_overflow(sample.stamp.ns, wheels_moved_.ns, &sample.stamp.ns)) {
      return Error{path.string() + ": stamps that are moved by " +
                   std::to_string(-wheels_moved_.seconds()) + " s are beyond what a clock has"};
    }
  }
  return {};
}

Status Recording::read_pixels(const ListedFrame& listed, std::vector<std::uint8_t>& pixels) const {
  if (!options_.pixels) return {};
  const Lens& lens = config_.lens;
  const fs::path path = layout::frames(folder_) / listed.filename;
  const Status read = read_grey_png(path, lens.width_px, lens.height_px, pixels);
  if (read) return {};
  return Error{layout::frame_list(folder_).string() + ":" + std::to_string(listed.line) + ": " +
               read.error().message};
}

Result<bool> Recording::next(SourceFrame& frame) {
  while (position_ < frames_.size()) {
    const ListedFrame& listed = frames_[position_++];
    const Status read = read_pixels(listed, frame.pixels);
    if (!read && !options_.skip_damaged) {
      return Error{read.error().message + "; --skip-damaged goes on without"};
    }
    if (!read) {
      if (skipped_++ == 0) first_skipped_ = read.error().message;
      continue;
    }
    frame.stamp = listed.stamp;
    frame.truth = pose_at(truth_, listed.stamp);
    wheels_.take(listed.stamp, frame.wheels);
    return true;
  }
  if (skipped_ == frames_.size()) return Error{first_skipped_ + "; no frame is left"};
  return false;
}

std::vector<std::string> Recording::warnings() const {
  std::vector<std::string> all = warnings_;
  if (skipped_ > 0) {
    all.push_back(first_skipped_ + "; " + std::to_string(skipped_) + " of " +
                  std::to_string(frames_.size()) + " frames left out");
  }
  return all;
}

}  // namespace zenith
