#include "platform/recording/wheel_log.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>

#include "platform/recording/seconds.h"

namespace zenith {
namespace {

constexpr std::size_t kMaxUnknownIds = 4096;  // all short ones, and more than any bus has

void decode_frame(const CanFrame& frame, WheelDecoder& decoder, WheelLog& log) {
  const std::uint64_t unknown = decoder.counters().unknown_ids;
  if (const auto sample = decoder.decode(frame)) log.samples.push_back(*sample);
  if (decoder.counters().unknown_ids == unknown) return;
  if (log.unknown_ids.size() < kMaxUnknownIds || log.unknown_ids.contains(id_of(frame))) {
    ++log.unknown_ids[id_of(frame)];
  } else {
    ++log.further_unknown;
  }
}

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f s", seconds);
  return text;
}

// As candump writes them: three digits, or eight for 29 bits.
std::string id_text(const CanId& id) {
  char text[16];
  std::snprintf(text, sizeof text, id.extended ? "%08X" : "%03X", id.id);
  return text;
}

std::string expected_text(const WheelLog& log) {
  std::string ids;
  for (const CanId& id : log.expected_ids) ids += (ids.empty() ? "" : ", ") + id_text(id);
  return ids;
}

// Both wheels stand for as long as a drive takes.
bool never_moves(const WheelLog& log) {
  constexpr double kDrive_s = 10.0;
  constexpr double kStands_m = 0.005;
  if (log.samples.empty() || log.fault.kind != WheelFaultKind::kNone) return false;
  const WheelSample& first = log.samples.front();
  if ((log.samples.back().stamp - first.stamp).seconds() < kDrive_s) return false;
  return std::all_of(log.samples.begin(), log.samples.end(), [&](const WheelSample& sample) {
    return std::abs(sample.left_m - first.left_m) < kStands_m &&
           std::abs(sample.right_m - first.right_m) < kStands_m;
  });
}

// The likely reason of wheels and frames without a time in common.
std::string why_apart(const WheelLog& log, const std::vector<ListedFrame>& frames) {
  if (log.decoder.late > log.samples.size()) {
    return std::to_string(log.decoder.late) +
           " stamps do not rise and were refused; expected the lines in order of time";
  }
  constexpr double kLike = 0.2;
  const auto ratio = [](Time of, Time to) {
    return static_cast<double>(of.ns) / static_cast<double>(std::max<std::int64_t>(to.ns, 1));
  };
  for (const auto& [factor, unit] :
       {std::pair{1e3, "milliseconds"}, {1e6, "microseconds"}, {1e9, "nanoseconds"}}) {
    const bool like =
        std::abs(ratio(log.samples.front().stamp, frames.front().stamp) / factor - 1.0) < kLike &&
        std::abs(ratio(log.samples.back().stamp, frames.back().stamp) / factor - 1.0) < kLike;
    if (like) {
      return std::string("the odometry's stamps seem to be ") + unit + "; expected seconds";
    }
  }
  return "are both stamped by the same clock?";
}

std::string unknown_text(const WheelLog& log) {
  std::size_t total = log.further_unknown;
  std::string ids;
  std::size_t shown = 0;
  for (const auto& [id, count] : log.unknown_ids) {
    total += count;
    if (++shown > 8) continue;
    ids += (ids.empty() ? "" : ", ") + id_text(id) + " (" + std::to_string(count) + ")";
  }
  if (log.unknown_ids.size() > 8) {
    ids += ", ... (" + std::to_string(log.unknown_ids.size()) + " identifiers in all)";
  }
  return std::to_string(total) + " frames with identifiers that the codec does not know: " + ids +
         (log.samples.empty() ? "; it expects " + expected_text(log) : "");
}

// Frames with an expected number, but of the other length.
std::vector<std::string> other_lengths(const WheelLog& log) {
  std::vector<std::string> lines;
  for (const CanId& id : log.expected_ids) {
    const auto found = log.unknown_ids.find({id.id, !id.extended});
    if (found == log.unknown_ids.end()) continue;
    lines.push_back(std::to_string(found->second) + " frames of " + id_text(found->first) +
                    (id.extended ? ", an 11-bit identifier; the codec expects 29 bits, "
                                 : ", a 29-bit identifier; the codec expects 11 bits, ") +
                    id_text(id) +
                    (id.extended ? ": in a DBC file, take 2147483648 from the message's number"
                                 : ": in a DBC file, add 2147483648 to the message's number"));
  }
  return lines;
}

// What no CAN bus was wrong about.
std::string file_fault_text(const WheelFault& fault) {
  if (fault.kind == WheelFaultKind::kLeftStands || fault.kind == WheelFaultKind::kRightStands) {
    const bool left = fault.kind == WheelFaultKind::kLeftStands;
    return std::string("the ") + (left ? "left" : "right") + " wheel never moved while the other " +
           "rolled " + std::to_string(fault.travel_m) + " m, expected both to turn";
  }
  return "steps that are faster than odometry.max_wheel_speed_mps come again and again, expected "
         "none; is it the travel since the start in metres, and are the stamps right?";
}

}  // namespace

Result<WheelLog> read_wheel_log(const std::filesystem::path& path, const std::string& interface,
                                WheelDecoder decoder, std::optional<Time> start) {
  auto can = read_can_log(path, interface, start);
  if (!can.ok()) return can.error();
  WheelLog log;
  log.is_can = true;
  log.expected_ids = decoder.ids();
  log.can = std::move(*can);
  for (const CanFrame& frame : log.can.frames) decode_frame(frame, decoder, log);
  log.can.frames = {};
  log.decoder = decoder.counters();
  log.fault = decoder.fault();
  log.malformed = log.can.malformed;
  if (log.malformed > 0) {
    log.first_malformed = log.can.first_malformed +
                          ": malformed line, expected '(seconds) interface ID#DATA' or another "
                          "form of candump, found '" +
                          log.can.malformed_text + "'";
  }
  return check_log(std::move(log), path);
}

Result<WheelLog> check_log(WheelLog log, const std::filesystem::path& path) {
  std::string message = path.string() + ": ";
  if (log.fault.kind != WheelFaultKind::kNone) {
    message += log.is_can ? wheel_fault_text(log.fault) : file_fault_text(log.fault);
  } else if (log.samples.empty()) {
    message += "holds no odometry";
  } else {
    return log;
  }
  for (const std::string& trouble : describe_log(log, path)) message += "\n" + trouble;
  return Error{message};
}

std::vector<std::string> describe_log(const WheelLog& log, const std::filesystem::path& path) {
  std::vector<std::string> lines;
  const std::string name = path.string() + ": ";
  const auto tell = [&](std::uint64_t count, const std::string& what) {
    if (count > 0) lines.push_back(name + std::to_string(count) + " " + what);
  };
  if (log.malformed > 0) {
    lines.push_back(log.first_malformed +
                    (log.malformed > 1 ? "; " + std::to_string(log.malformed - 1) + " more" : ""));
  }
  tell(log.can.other_interfaces, "frames of other interfaces, ignored; expected " +
                                     path.stem().string() + ", odometry.can_interface");
  tell(log.can.other_frames, "remote or error frames, ignored");
  tell(log.can.fd_frames, "CAN FD frames, ignored: wheels are read from classic frames alone");
  tell(log.can.drop_reports, "times candump lost frames: record with a larger buffer, -r");
  if (log.can.local_dates) {
    lines.push_back(name +
                    "dates (candump -tA) name no time zone, taken as UTC; record with "
                    "candump -L, or set odometry.log_start_s");
  }
  if (!log.unknown_ids.empty()) lines.push_back(name + unknown_text(log));
  for (const std::string& other : other_lengths(log)) lines.push_back(name + other);
  tell(log.decoder.late, "odometry readings whose stamps do not rise, refused");
  tell(log.decoder.short_frames, "odometry frames that are too short, refused");
  tell(log.decoder.invalid, "odometry readings with impossible values, refused");
  tell(log.decoder.resets, "restarts of the base's counters");
  tell(log.decoder.velocity_gaps, "gaps between velocities, bridged only in part");
  tell(log.decoder.unpaired, "frames of one wheel without a partner from the other");
  tell(log.decoder.error_reports, "reports of errors by the drives");
  if (never_moves(log)) {
    lines.push_back(name +
                    "the wheels never move; expected travel, if the robot was driven: does the "
                    "codec read the right signals, is the travel a total that grows?");
  }
  return lines;
}

Result<std::vector<std::string>> describe_gaps(const WheelLog& log,
                                               const std::vector<ListedFrame>& frames,
                                               const std::filesystem::path& path,
                                               double max_gap_s) {
  const auto& samples = log.samples;
  const Time first = samples.front().stamp;
  const Time last = samples.back().stamp;
  const auto before = [](const ListedFrame& frame, Time stamp) { return frame.stamp < stamp; };
  const auto after = [](Time stamp, const ListedFrame& frame) { return stamp < frame.stamp; };
  if (frames.back().stamp < first || frames.front().stamp > last) {
    return Error{path.string() + ": odometry (" + format_seconds(first) + " .. " +
                 format_seconds(last) + ") and frames (" + format_seconds(frames.front().stamp) +
                 " .. " + format_seconds(frames.back().stamp) +
                 ") have no time in common: " + why_apart(log, frames)};
  }
  std::vector<std::string> lines;
  std::size_t gaps = 0;
  std::size_t longest = 0;
  double longest_s = 0.0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double gap = (samples[i].stamp - samples[i - 1].stamp).seconds();
    if (gap <= max_gap_s) continue;
    const auto frame = std::upper_bound(frames.begin(), frames.end(), samples[i - 1].stamp, after);
    if (frame == frames.end() || frame->stamp >= samples[i].stamp) continue;
    ++gaps;
    if (gap > longest_s) longest = i - 1;
    longest_s = std::max(longest_s, gap);
  }
  if (gaps > 0) {
    lines.push_back(path.string() + ": " + std::to_string(gaps) + (gaps == 1 ? " gap" : " gaps") +
                    " in the odometry while frames go on, the longest " + seconds_text(longest_s) +
                    " after " + format_seconds(samples[longest].stamp));
  }
  const auto early = std::lower_bound(frames.begin(), frames.end(), first, before) - frames.begin();
  const auto late = frames.end() - std::upper_bound(frames.begin(), frames.end(), last, after);
  if (early > 0) {
    lines.push_back(path.string() + ": begins after " + std::to_string(early) + " frames");
  }
  if (late > 0 && (frames.back().stamp - last).seconds() > max_gap_s) {
    lines.push_back(path.string() + ": ends before the last " + std::to_string(late) + " frames");
  }
  return lines;
}

}  // namespace zenith
