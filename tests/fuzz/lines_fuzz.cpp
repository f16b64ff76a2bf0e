// Any text as what recordings hold line by line: the first byte chooses a CAN log, a list of
// frames, a trajectory, the wheels' travel, the base's own poses or clocks.

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/odometry/wheel_decoder.h"
#include "platform/recording/can_log.h"
#include "platform/recording/candump.h"
#include "platform/recording/clock_log.h"
#include "platform/recording/frame_list.h"
#include "platform/recording/ground_truth.h"
#include "platform/recording/odometry_frames.h"
#include "platform/recording/pose_travel.h"
#include "platform/recording/travel_file.h"
#include "tests/fuzz/require.h"

namespace {

using namespace zenith;  // NOLINT(google-build-using-namespace)

constexpr LineLimits kLimits = {1 << 20, 256};

void read_can(std::string_view text, std::optional<Time> start) {
  InputLines lines(text, "can0.log", kLimits);
  const auto log = parse_can_log(lines, "can0", start);
  require(!log.ok() || lines.status().ok());
  if (!log) {
    require(log.error().message.starts_with("can0.log"));
    return;
  }
  require((log->malformed == 0) == log->first_malformed.empty());
  WheelDecoder decoder;
  Time last = {-1};
  for (const CanFrame& frame : log->frames) {
    require(frame.length <= 8 && frame.stamp.ns >= 0);
    if (const auto sample = decoder.decode(frame)) {
      require(sample->stamp > last);
      last = sample->stamp;
    }
    const std::string line = format_candump(frame, "can0");
    const CandumpRecord record = parse_candump(line);
    const CanFrame& again = record.frame;
    require(record.line == CandumpLine::kFrame && record.stamp == CandumpStamp::kSeconds);
    require(record.interface == "can0" && again.id == frame.id && again.length == frame.length);
    require(again.extended == frame.extended && again.data == frame.data);
    require(again.stamp.ns == frame.stamp.ns / 1000 * 1000);
  }
}

void read_frames(std::string_view text) {
  InputLines lines(text, "data.csv", kLimits);
  const auto frames = parse_frame_list(lines);
  if (!frames) {
    require(frames.error().message.starts_with("data.csv"));
    return;
  }
  require(!frames->empty());
  Time last = {-1};
  for (const ListedFrame& frame : *frames) {
    require(frame.stamp > last);
    last = frame.stamp;
    require(frame.filename.find('/') == std::string::npos && frame.filename[0] != '.');
  }
}

void read_poses(std::string_view text) {
  InputLines lines(text, "groundtruth.tum", kLimits);
  const auto poses = parse_tum(lines);
  if (!poses) return;
  for (const StampedPose& pose : *poses) {
    const auto there = pose_at(*poses, pose.stamp);
    require(there && there->x_m == pose.pose.x_m);
    (void)pose_at(*poses, Time{pose.stamp.ns + 1});
    require(format_tum(pose).size() > 10);
  }
}

void check_wheels(const Result<WheelLog>& log) {
  if (!log) return;
  require(!log->samples.empty());
  require((log->malformed == 0) == log->first_malformed.empty());
  const WheelSample* last = nullptr;
  for (const WheelSample& sample : log->samples) {
    require(std::isfinite(sample.left_m) && std::isfinite(sample.right_m));
    require(last == nullptr || sample.stamp > last->stamp);
    last = &sample;
    const CanFrame frame = frame_of_sample(sample);
    require(frame.length == 8 && frame.stamp == sample.stamp);
  }
  (void)describe_log(*log, "odometry");
}

void read_travel(std::string_view text) {
  InputLines lines(text, "odometry.csv", kLimits);
  check_wheels(parse_travel_file(lines, {}));
}

void read_poses_of_base(std::string_view text) {
  InputLines lines(text, "odometry.tum", kLimits);
  check_wheels(parse_pose_travel(lines, {}));
}

void read_clocks_of(std::string_view text) {
  InputLines lines(text, "clock.csv", kLimits);
  const auto log = parse_clock_log(lines);
  if (!log) {
    require(log.error().message.starts_with("clock.csv"));
    return;
  }
  Time last = {0};
  for (const ClockReading& r : log->readings()) {
    require(r.monotonic >= last);
    // Time never falls, whatever the clocks did.
    require(r.monotonic + log->offset(r.monotonic) >= last + log->offset(last));
    last = r.monotonic;
  }
  (void)log->stepped();
  require(log->slept().ns >= 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  switch (data[0] % 6) {  // '0' to '5'
    case 0:
      read_can(text, std::nullopt);
      read_can(text, Time{5'000'000'000});
      break;
    case 1:
      read_frames(text);
      break;
    case 2:
      read_poses(text);
      break;
    case 3:
      read_travel(text);
      break;
    case 4:
      read_poses_of_base(text);
      break;
    default:
      read_clocks_of(text);
  }
  return 0;
}
