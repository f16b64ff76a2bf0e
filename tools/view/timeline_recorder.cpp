#include "tools/view/timeline_recorder.h"

#include <fstream>

#include "platform/linux/clock.h"
#include "tools/view/jpeg.h"
#include "tools/view/kept_lines.h"
#include "tools/view/robot_state.h"
#include "tools/view/timeline.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

constexpr Duration kTurn = {50'000'000};
constexpr Duration kPictureEvery = {500'000'000};
constexpr Duration kAskEvery = {1'000'000'000};

struct Recorded {
  std::size_t number;
  TelemetryLink link;
  RobotState state;
  std::uint64_t version = 0;
  KeptLines kept{kPictureEvery};
};

class Writer {
 public:
  Writer(const std::filesystem::path& file, const std::vector<std::string>& names, Time begin)
      : out_(file, std::ios::binary), begin_(begin) {
    out_ << json({{"timeline", 1}, {"robots", names}}).dump() << '\n';
  }
  void put(std::size_t robot, Time now, std::string_view line) {
    out_ << "{\"t_s\":" << (now - begin_).seconds() << ",\"robot\":" << robot
         << ",\"line\":" << line << "}\n";
  }
  bool close() {
    out_.close();
    return !out_.fail();
  }

 private:
  std::ofstream out_;
  Time begin_;
};

void take(Recorded& robot, std::string_view text, Time now, Writer& writer) {
  const DecodedLine decoded = decode_telemetry(text);
  if (!decoded.line) return;  // it is not kept
  robot.state.apply(*decoded.line, ++robot.version);
  const std::string kept = robot.kept.take(robot.state, *decoded.line, text, now);
  if (!kept.empty()) writer.put(robot.number, now, kept);
}

}  // namespace

TimelineRecorder::TimelineRecorder(const std::filesystem::path& file,
                                   std::vector<std::string> names, std::vector<RobotAddress> robots)
    : file_(file), thread_([this, names = std::move(names), robots = std::move(robots)] {
        run(names, robots);
      }) {}

Status TimelineRecorder::finish() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  if (failed_) return Error{file_.string() + ": cannot be written: is the disk full?"};
  return {};
}

void TimelineRecorder::run(std::vector<std::string> names, std::vector<RobotAddress> robots) {
  Writer writer(file_, names, monotonic_now());
  std::vector<Recorded> all;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    all.push_back({i, TelemetryLink(std::move(robots[i])), RobotState(names[i], write_jpeg)});
  }
  Time next_ask;
  while (!stop_) {
    const Time now = monotonic_now();
    const bool ask = now >= next_ask;
    if (ask) next_ask = now + kAskEvery;
    for (Recorded& robot : all) {
      robot.link.turn(now, [&](std::string_view text) { take(robot, text, now, writer); });
      if (ask) robot.link.ask_picture();
    }
    sleep_until(now + kTurn);
  }
  failed_ = !writer.close();
}

}  // namespace zenith::tools
