#include "tools/record/record.h"

#include <sys/statvfs.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <utility>

#include "platform/linux/clock.h"
#include "platform/recording/clock_log.h"
#include "platform/recording/layout.h"
#include "tools/record/frame_store.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;

constexpr double kMega = 1e6;
constexpr Duration kTake = {50'000'000};
constexpr Duration kFlush = {1'000'000'000};
constexpr const char* kDbcName = "base.dbc";

// Infinite when the disk does not say.
double free_mb(const fs::path& folder) {
  struct statvfs disk = {};
  if (::statvfs(folder.c_str(), &disk) != 0) return std::numeric_limits<double>::infinity();
  return static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize) / kMega;
}

Result<RecordingWriter> create_writer(const fs::path& out, const tap::Hello& robot) {
  RobotFile file;
  file.wheels = robot.config.wheels;
  file.odometry = robot.odometry;
  file.can_interface = robot.can_interface;
  const bool has_dbc = robot.odometry.kind == WheelCodecKind::kDbc;
  file.odometry.dbc.file = has_dbc ? kDbcName : "";
  auto writer = RecordingWriter::create(out, robot.config, file);
  if (!writer || !has_dbc) return writer;
  const Status copied = writer->add_file(kDbcName, robot.dbc);
  if (!copied) return copied.error();
  return writer;
}

// Counts, and hands on to the files.
class Recorder final : public RecordSink {
 public:
  Recorder(const RecordPlan& plan, RecordingWriter writer)
      : plan_(plan), writer_(std::move(writer)), frames_(writer_, plan.compression, plan.threads) {}

  void frame(const tap::FrameHead& head, ImageView image) override {
    if (has_frame_ && head.stamp <= last_.stamp) {
      ++figures_.out_of_order;
      return;
    }
    // A reopened camera counts from 0 again.
    if (has_frame_ && head.sequence > last_.sequence) {
      gaps_ += head.sequence - last_.sequence - 1;
    }
    if (!has_frame_) first_ = head.stamp;
    has_frame_ = true;
    last_ = head;
    if (!frames_.add(head.stamp, image, plan_.patience)) ++lost_here_;
  }
  void can(std::span<const CanFrame> frames) override {
    for (const CanFrame& frame : frames) writer_.add_can(frame);
    figures_.can += frames.size();
  }
  void pose(const tap::TappedPose& pose) override {
    writer_.add_estimate(pose.stamp, pose.pose);
    ++figures_.poses;
  }

  // How the clocks lie now; `always`: also when nothing has changed.
  void clocks(const ClockReading& reading, bool always) {
    if (changes_.is_change(reading) || always) writer_.add_clock(reading);
    figures_.synchronised = reading.synchronised;
  }

  // The files hold all but what is under way.
  Status flush() {
    const Status stored = frames_.collect();
    const Status flushed = writer_.flush();
    return stored ? flushed : stored;
  }
  Status finish() {
    const Status stored = frames_.finish();
    const Status flushed = writer_.finish();
    return stored ? flushed : stored;
  }

  // `dropped` frames have numbers, too, but the recorder's source lost them, not the robot.
  RecordFigures& figures(const tap::End& end) {
    (void)frames_.collect();
    figures_.seconds = has_frame_ ? (last_.stamp - first_).seconds() : 0.0;
    figures_.frames = frames_.frames();
    figures_.bytes = frames_.bytes() + writer_.list_bytes();
    figures_.left_out = lost_here_ + end.frames_dropped;
    figures_.can_left_out = end.can_dropped;
    figures_.passed_over = gaps_ - std::min(gaps_, end.frames_dropped);
    figures_.free_mb = free_mb(plan_.out);
    return figures_;
  }

 private:
  const RecordPlan& plan_;
  RecordingWriter writer_;
  FrameStore frames_;
  RecordFigures figures_;
  ClockChanges changes_;
  bool has_frame_ = false;
  Time first_;
  tap::FrameHead last_;
  std::uint64_t gaps_ = 0;
  std::uint64_t lost_here_ = 0;
};

std::string megabytes(double mb) {
  char text[32];
  std::snprintf(text, sizeof text, mb < 10000.0 ? "%.0f MB" : "%.3g MB", mb);
  return text;
}

// Why it must end now; empty while it need not.
std::string limit_reached(const RecordPlan& plan, const RecordFigures& figures) {
  if (plan.duration_s > 0.0 && figures.seconds >= plan.duration_s) return "the duration is reached";
  if (plan.max_size_mb > 0.0 && static_cast<double>(figures.bytes) >= plan.max_size_mb * kMega) {
    return "the size is reached";
  }
  return {};
}

}  // namespace

Status check_record_target(const fs::path& out) {
  std::error_code code;
  const fs::file_status status = fs::symlink_status(out, code);
  if (!fs::exists(status)) return {};
  return Error{out.string() + ": exists already; recordings are never overwritten: name another"};
}

Result<RecordFigures> record(const RecordPlan& plan, RecordSource& source,
                             const std::function<bool()>& stop,
                             const std::function<void(const RecordFigures&)>& tell) {
  if (const Status target = check_record_target(plan.out); !target) return target.error();
  auto writer = create_writer(plan.out, source.robot());
  if (!writer) return writer.error();
  if (const double free = free_mb(plan.out); free < plan.keep_free_mb) {
    return Error{plan.out.string() + ": the disk has " + megabytes(free) + " left, less than the " +
                 megabytes(plan.keep_free_mb) + " that --keep-free leaves to others"};
  }
  Recorder recorder(plan, std::move(*writer));
  recorder.clocks(plan.clocks(), true);
  std::string why;
  bool failed = false;
  const auto end_with = [&](const std::string& reason, bool is_failure) {
    if (why.empty()) {
      why = reason;
      failed = is_failure;
    }
    source.finish();
  };
  Time next_flush = monotonic_now() + kFlush;
  for (bool more = true; more;) {
    const auto taken = source.take(kTake, recorder);
    more = taken && *taken;
    if (!taken) end_with(taken.error().message, true);
    recorder.clocks(plan.clocks(), !more);
    const RecordFigures& figures = recorder.figures(source.end());
    tell(figures);
    if (more && stop()) end_with("stopped", false);
    if (more && figures.free_mb < plan.keep_free_mb) end_with("the disk is nearly full", true);
    if (const std::string limit = limit_reached(plan, figures); more && !limit.empty()) {
      end_with(limit, false);
    }
    if (monotonic_now() < next_flush) continue;
    next_flush = monotonic_now() + kFlush;
    if (const Status flushed = recorder.flush(); !flushed) {
      end_with(flushed.error().message, true);
      more = false;  // what is under way finds no place either
    }
  }
  const Status finished = recorder.finish();
  RecordFigures figures = recorder.figures(source.end());
  figures.why = why.empty() ? source.end().why : why;
  figures.failed = failed || !finished;
  if (!finished && why.empty()) figures.why = finished.error().message;
  return figures;
}

std::string record_summary(const RecordPlan& plan, const RecordFigures& figures) {
  char text[256];
  std::snprintf(
      text, sizeof text, ": %.1f s, %llu frames (%.1f/s), %llu CAN frames, %.1f MB",
      figures.seconds, static_cast<unsigned long long>(figures.frames),
      figures.seconds > 0.0 ? static_cast<double>(figures.frames - 1) / figures.seconds : 0.0,
      static_cast<unsigned long long>(figures.can), static_cast<double>(figures.bytes) / kMega);
  std::string lines = plan.out.string() + text + "; ended: " + figures.why + "\n";
  const auto tell = [&lines](std::uint64_t count, const char* what) {
    if (count > 0) lines += std::to_string(count) + " " + what + "\n";
  };
  tell(figures.left_out, "frames are missing: this computer or its disk was too slow for them");
  tell(figures.can_left_out, "CAN frames are missing for the same reason");
  tell(figures.passed_over, "frames more the camera took, but the robot did not see them either");
  tell(figures.out_of_order, "frames whose stamps do not rise were left out");
  if (figures.frames == 0) return lines + "No frame came: there is nothing to replay.\n";
  if (figures.can == 0) {
    lines += "No CAN frame came: a replay needs the wheels. `zenith doctor` looks for the cause.\n";
  }
  if (!figures.synchronised) {
    lines +=
        "This computer's wall clock is not synchronised (NTP): together with other robots' "
        "recordings this one is replayed only as rightly as that clock goes.\n";
  }
  const std::string out = plan.out.string();
  return lines + "Map it:  zenith replay " + out + " --out " + out + "-map\n";
}

}  // namespace zenith::tools
