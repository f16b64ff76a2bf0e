#include "platform/daemon/simulated/recording_source.h"

#include <algorithm>
#include <utility>

#include "platform/linux/log.h"
#include "platform/recording/can_log.h"
#include "platform/recording/layout.h"
#include "platform/recording/odometry_file.h"
#include "platform/recording/odometry_frames.h"
#include "platform/recording/png.h"
#include "platform/recording/recording.h"

namespace zenith {
namespace {

// The last frame of each identifier that the decoder reads.
std::vector<CanFrame> last_of_each(const std::vector<CanFrame>& frames, const CanIds& ids) {
  std::vector<CanFrame> last;
  for (auto frame = frames.rbegin(); frame != frames.rend() && last.size() < ids.size(); ++frame) {
    const auto same = [&](const CanFrame& other) { return id_of(other) == id_of(*frame); };
    if (passes(*frame, ids) && std::none_of(last.begin(), last.end(), same)) last.push_back(*frame);
  }
  std::reverse(last.begin(), last.end());
  return last;
}

// Whether a base that sends nothing but these stands.
bool says_standing(const std::vector<CanFrame>& frames, WheelDecoder decoder) {
  constexpr int kTimes = 8;
  bool stands = true;
  for (int i = 0; i < kTimes; ++i) {
    for (CanFrame frame : frames) {
      frame.stamp = Time{1'000'000'000} + Duration{i * 10'000'000LL};
      const auto sample = decoder.decode(frame);
      if (sample) stands = stands && sample->left_m == 0.0 && sample->right_m == 0.0;
    }
  }
  return stands;
}

}  // namespace

Result<std::unique_ptr<RecordingSource>> RecordingSource::open(const ReplayConfig& config) {
  std::unique_ptr<RecordingSource> source(new RecordingSource);
  source->config_ = config;
  if (const Status loaded = source->load(); !loaded) return loaded.error();
  return source;
}

Status RecordingSource::load() {
  const std::filesystem::path folder = config_.folder;
  ReadOptions options;
  options.pixels = false;
  const auto recording = Recording::open(folder, options);
  if (!recording) return recording.error();
  const auto file = read_robot_file(layout::robot(folder));
  if (!file) return file.error();
  auto frames = read_frame_list(layout::frame_list(folder));
  if (!frames) return frames.error();
  if (const Status wheels = load_wheels(*file); !wheels) return wheels;
  auto decoder = make_wheel_decoder(odometry_);
  if (!decoder) return decoder.error();
  quantity_ = wheel_quantity(odometry_);
  if (quantity_ == WheelQuantity::kVelocity && config_.speed != 1.0) {
    return Error{"replay.speed is not 1, but the base of " + config_.folder +
                 " reports velocities, which another speed would make wrong"};
  }
  name_ = (*recording)->name();
  robot_ = (*recording)->config();
  robot_.frame_rate_hz *= config_.speed;
  warnings_ = (*recording)->warnings();
  decoder_ = *decoder;
  frames_ = std::move(*frames);
  for (std::size_t i = 1; i < can_.size(); ++i) {
    can_[i].stamp = std::max(can_[i].stamp, can_[i - 1].stamp);
  }
  first_ = std::min(frames_.front().stamp, can_.front().stamp);  // Recording wants some of both
  base_ = first_;
  return {};
}

// The frames of the CAN log, or such as tell the same.
Status RecordingSource::load_wheels(const RobotFile& robot) {
  const auto file = find_odometry(config_.folder, robot.can_interface);
  if (!file) return file.error();
  if (file->format == OdometryFormat::kCanLog) {
    auto can = read_can_log(file->path, robot.can_interface, robot.log_start());
    if (!can) return can.error();
    odometry_ = robot.odometry;
    can_ = std::move(can->frames);
    return {};
  }
  const auto log = read_odometry(*file, robot);
  if (!log) return log.error();
  odometry_ = codec_of_samples(robot.odometry.limits);
  for (const WheelSample& sample : log->samples) can_.push_back(frame_of_sample(sample));
  return {};
}

Time RecordingSource::played(Time recorded) const {
  const auto since = static_cast<double>((recorded - first_).ns);
  return base_ + Duration{static_cast<std::int64_t>(since / config_.speed)};
}

Duration RecordingSource::frame_period() const {
  return Duration::from_seconds(1.0 / robot_.frame_rate_hz);
}

bool RecordingSource::next(Moment& moment) {
  if (next_frame_ == frames_.size() && next_can_ == can_.size()) {
    if (!config_.loop) return false;
    begin_anew();
  }
  moment.frame = MomentFrame::kNone;
  if (next_frame_ < frames_.size()) {
    const ListedFrame& listed = frames_[next_frame_++];
    take_can(listed.stamp, moment.can);
    take_frame(listed, moment);
  } else {
    take_can(can_.back().stamp, moment.can);
    moment.stamp = moment.can.back().stamp;
  }
  last_ = std::max(moment.stamp, last_);
  return true;
}

void RecordingSource::begin_anew() {
  log_line(LogLevel::kNotice, "replay: the recording begins anew");
  base_ = last_ + frame_period();
  next_frame_ = 0;
  next_can_ = 0;
}

void RecordingSource::take_can(Time until, std::vector<CanFrame>& out) {
  out.clear();
  for (; next_can_ < can_.size() && can_[next_can_].stamp <= until; ++next_can_) {
    out.push_back(can_[next_can_]);
    out.back().stamp = played(can_[next_can_].stamp);
  }
}

void RecordingSource::take_frame(const ListedFrame& listed, Moment& moment) {
  const std::filesystem::path path = layout::frames(config_.folder) / listed.filename;
  const Lens& lens = robot_.lens;
  const Status read = read_grey_png(path, lens.width_px, lens.height_px, moment.pixels);
  moment.stamp = played(listed.stamp);
  moment.frame = read ? MomentFrame::kGood : MomentFrame::kDamaged;
  if (read) return;
  if (bad_++ > 0) return;
  log_line(LogLevel::kWarning, "replay: %s; passed over", read.error().message.c_str());
}

// Positions stay as they were; of velocities all bits are zero, where that means none.
std::vector<CanFrame> RecordingSource::standing() const {
  std::vector<CanFrame> frames = last_of_each(can_, decoder_.ids());
  if (quantity_ == WheelQuantity::kVelocity) {
    for (CanFrame& frame : frames) frame.data = {};
  }
  if (!says_standing(frames, decoder_)) frames.clear();
  return frames;
}

void RecordingSource::ended() {
  log_line(LogLevel::kNotice,
           "replay: the end of the recording %s: %zu frames, of which %zu were missing or damaged; "
           "the robot stands from here on%s",
           name_.c_str(), frames_.size(), bad_,
           standing().empty() ? ", and its CAN bus is silent" : "");
}

}  // namespace zenith
