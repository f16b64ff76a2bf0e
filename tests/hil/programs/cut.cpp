// hil-cut, on the host: makes a play (play_folder.h) of a part of a recording. The robot's base
// must speak agilex_v2, the configuration's default, as simulated ones do.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "platform/recording/candump.h"
#include "platform/recording/layout.h"
#include "platform/recording/recording.h"

namespace zenith::hil {
namespace {

namespace fs = std::filesystem;

constexpr const char* kInterface = "can0";
// Where canplayer's log begins: it wants seconds of an epoch.
constexpr Time kLogStart = {1'000'000'000'000'000'000};

struct Part {
  fs::path recording;
  fs::path play;
  double from_s = 0.0;  // since the recording's first frame
  double to_s = 0.0;
  double slower = 1.0;
};

struct Play {
  std::vector<CanFrame> can;  // the first one is the beginning
  double slower = 1.0;

  std::int64_t time_of(Time stamp) const {
    const Duration since = stamp - can.front().stamp;
    return static_cast<std::int64_t>(static_cast<double>(since.ns) * slower);
  }
};

Result<std::vector<CanFrame>> read_can(const fs::path& recording) {
  const fs::path path = layout::can_log(recording, kInterface);
  std::ifstream in(path);
  std::vector<CanFrame> frames;
  std::string line;
  while (std::getline(in, line)) {
    const CandumpRecord record = parse_candump(line);
    if (record.line == CandumpLine::kFrame) frames.push_back(record.frame);
  }
  if (frames.empty()) return Error{path.string() + ": no CAN frame; is it a recording?"};
  return frames;
}

// From the last frame at or before `from` to the first after `to`.
Status cut_can(std::vector<CanFrame> all, Time from, Time to, std::vector<CanFrame>& out) {
  for (const CanFrame& frame : all) {
    if (frame.stamp <= from) out.clear();
    out.push_back(frame);
    if (frame.stamp > to) break;
  }
  if (out.size() < 2 || out.front().stamp > from) {
    return Error{"the CAN log does not cover the part; choose another part"};
  }
  return {};
}

void write_can(const Play& play, const fs::path& folder) {
  std::ofstream log(folder / "can0.log");
  for (CanFrame frame : play.can) {
    frame.stamp = kLogStart + Duration{play.time_of(frame.stamp)};
    log << format_candump(frame, kInterface) << '\n';
  }
  std::ofstream standing(folder / "standing.log");
  CanFrame last = play.can.back();
  for (int i = 0; i < 20; ++i) {
    last.stamp = kLogStart + Duration{i * std::int64_t{50'000'000}};
    standing << format_candump(last, kInterface) << '\n';
  }
}

void write_description(const RobotConfig& robot, double slower, const fs::path& folder) {
  constexpr double kDegPerRad = 180.0 / std::numbers::pi;
  const Lens& l = robot.lens;
  const CameraMount& m = robot.mount;
  std::ofstream out(folder / "description.toml");
  out.precision(15);
  out << "[lens]\nwidth_px = " << l.width_px << "\nheight_px = " << l.height_px
      << "\nfu_px = " << l.fu_px << "\nfv_px = " << l.fv_px << "\ncu_px = " << l.cu_px
      << "\ncv_px = " << l.cv_px << "\nk1 = " << l.k[0] << "\nk2 = " << l.k[1]
      << "\nk3 = " << l.k[2] << "\nk4 = " << l.k[3] << "\n[mount]\nx_m = " << m.x_m
      << "\ny_m = " << m.y_m << "\nz_m = " << m.z_m << "\nroll_deg = " << m.roll_rad * kDegPerRad
      << "\npitch_deg = " << m.pitch_rad * kDegPerRad << "\nyaw_deg = " << m.yaw_rad * kDegPerRad
      << "\n[wheels]\ntrack_width_m = " << robot.wheels.track_width_m
      << "\nleft_scale = " << robot.wheels.left_scale
      << "\nright_scale = " << robot.wheels.right_scale << "\n";
  std::ofstream(folder / "rate.txt") << robot.frame_rate_hz / slower << "\n";
}

std::ostream& operator<<(std::ostream& out, const Pose2& pose) {
  return out << pose.x_m << ' ' << pose.y_m << ' ' << pose.theta_rad;
}

Status write_frames(Recording& recording, const Part& part, Play& play) {
  auto all_can = read_can(part.recording);
  if (!all_can) return all_can.error();
  std::ofstream pixels(part.play / "frames.grey", std::ios::binary);
  std::ofstream truth(part.play / "truth.txt");
  truth.precision(9);
  std::string times;
  Pose2 T_world_start;
  Time first = {-1};
  int count = 0;
  SourceFrame frame;
  for (;;) {
    const auto more = recording.next(frame);
    if (!more) return more.error();
    if (!*more) break;
    if (first.ns < 0) first = frame.stamp;
    const double at_s = (frame.stamp - first).seconds();
    if (at_s < part.from_s) continue;
    if (at_s > part.to_s) break;
    if (!frame.truth) return Error{"the recording has no groundtruth.tum; nothing could be judged"};
    if (count++ == 0) {
      const Time to = first + Duration::from_seconds(part.to_s);
      const Status cut = cut_can(std::move(*all_can), frame.stamp, to, play.can);
      if (!cut) return cut;
      T_world_start = *frame.truth;
      std::ofstream start(part.play / "start.txt");
      start.precision(9);
      start << T_world_start << "\n";
    }
    const std::int64_t time = play.time_of(frame.stamp);
    times += std::to_string(time) + "\n";
    truth << time << ' ' << T_world_start.inverse() * *frame.truth << "\n";
    pixels.write(reinterpret_cast<const char*>(frame.pixels.data()),
                 static_cast<std::streamsize>(frame.pixels.size()));
  }
  if (count < 2) return Error{"fewer than two frames lie in that part of the recording"};
  const Lens& lens = recording.config().lens;
  std::ofstream(part.play / "frames.txt")
      << lens.width_px << ' ' << lens.height_px << ' ' << count << "\n"
      << times;
  if (!pixels.flush()) return Error{"the pictures could not be written; is the disk full?"};
  return {};
}

Status cut(const Part& part) {
  auto recording = Recording::open(part.recording, {});
  if (!recording) return recording.error();
  fs::create_directories(part.play);
  Play play;
  play.slower = part.slower;
  const Status written = write_frames(**recording, part, play);
  if (!written) return written;
  write_can(play, part.play);
  write_description((*recording)->config(), part.slower, part.play);
  return {};
}

}  // namespace
}  // namespace zenith::hil

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr,
                 "Usage: hil-cut RECORDING PLAY FROM_S TO_S SLOWER\n\n"
                 "Makes the folder PLAY of a part of a recording, SLOWER times slower.\n");
    return 2;
  }
  const zenith::hil::Part part = {argv[1], argv[2], std::atof(argv[3]), std::atof(argv[4]),
                                  std::atof(argv[5])};
  if (part.to_s <= part.from_s || part.slower <= 0.0) {
    std::fprintf(stderr, "hil-cut: FROM_S must be less than TO_S, and SLOWER above 0\n");
    return 2;
  }
  const zenith::Status done = zenith::hil::cut(part);
  if (!done) std::fprintf(stderr, "hil-cut: %s\n", done.error().message.c_str());
  return done ? 0 : 1;
}
