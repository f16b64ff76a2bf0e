#include "tools/clocks/wheel_offset.h"

#include <algorithm>
#include <cmath>

#include "tools/calibrate/seen_motion.h"
#include "tools/descriptors/extractor.h"
#include "tools/doctor/formatted.h"

namespace zenith::tools {
namespace {

constexpr double kMostOfLength = 0.4;
constexpr double kMost_s = 60.0;
// Beyond this no base is late: another clock.
constexpr double kOtherClock_s = 1000.0;

}  // namespace

Result<WheelOffset> measure_wheel_offset(Source& source, const Parameters& parameters) {
  const RobotConfig config = source.config();
  OwnExtractor extractor(config, parameters);
  SeenMotion seen;
  WheelCurve wheels;
  SourceFrame frame;
  std::optional<Time> start;
  double end_s = 0.0;
  for (;;) {
    const auto more = source.next(frame);
    if (!more) return more.error();
    if (!*more) break;
    if (!start) start = frame.stamp;
    for (const WheelSample& w : frame.wheels) {
      wheels.add((w.stamp - *start).seconds(), {w.left_m, w.right_m});
    }
    end_s = (frame.stamp - *start).seconds();
    const Lens& lens = config.lens;
    seen.add(end_s, extractor->extract(
                        {frame.pixels.data(), lens.width_px, lens.height_px, lens.width_px}));
  }
  const double most_s = std::min(kMostOfLength * end_s, kMost_s);
  const SetupFit fit = fit_setup(seen.intervals(), wheels, config.wheels, {-most_s, most_s});
  WheelOffset out;
  out.sure = fit.delay_is_sure();
  out.late_s = fit.delay_s;
  out.explained = 1.0 - fit.fit.turn_rest;
  out.gain = fit.gain;
  return out;
}

Result<WheelOffset> measure_wheel_offset(const std::filesystem::path& folder, ReadOptions reading,
                                         const Parameters& parameters) {
  reading.wheels_from_first_frame = true;
  const auto recording = Recording::open(folder, reading);
  if (!recording.ok()) return recording.error();
  auto offset = measure_wheel_offset(**recording, parameters);
  if (offset.ok()) offset->late_s += (*recording)->wheels_moved().seconds();
  return offset;
}

std::string wheel_offset_text(const std::string& robot, const WheelOffset& offset) {
  const double late_s = std::abs(offset.late_s);
  std::string text = robot + formatted(": the wheels' stamps are %.3f s %s against the frames'",
                                       late_s, offset.late_s > 0.0 ? "late" : "early");
  if (late_s > kOtherClock_s) {
    text += ", they are of another clock (one of wall time, the other of the time since the start)";
  }
  return text +
         formatted(": with that the wheels explain %.0f %% of the turning that is seen; ",
                   100.0 * offset.explained) +
         "expected one clock; to replay it so: --wheels-late " + robot +
         formatted("=%.3f", offset.late_s);
}

}  // namespace zenith::tools
