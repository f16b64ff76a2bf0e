#include "platform/recording/can_log.h"

#include <algorithm>
#include <utility>

#include "platform/base/printable.h"
#include "platform/recording/candump.h"

namespace zenith {

namespace {

// A frame is some 45 bytes of the log, and other interfaces' stand there too.
constexpr LineLimits kLimits = {128 * kMaxLoggedFrames};

constexpr Duration kLongest = {1'000'000'000'000'000'000};  // 31 years: sums stay in range

enum class LogClock { kRecordings, kFromFirst, kFromLast, kUnclear };

// The stamps of all lines, as they stand there: what clock they are of.
class LogStamps {
 public:
  // False: not of the kind of the others.
  bool add(const CandumpRecord& record, const InputLines& file) {
    if (lines_ == 0) {
      kind_ = record.stamp;
      first_ = record.frame.stamp;
      place_ = file.place();
      // candump's own -tz and -td begin with zero. In the log format other programs write small
      // seconds, too, of any clock.
      relative_ = kind_ == CandumpStamp::kFewSeconds && (record.columns || first_.ns == 0);
    } else if (record.stamp != kind_) {
      // -tz grows to ten digits after three centuries, but other programs' clocks may.
      const auto seconds = [](CandumpStamp kind) {
        return kind == CandumpStamp::kSeconds || kind == CandumpStamp::kFewSeconds;
      };
      if (relative_ || !seconds(kind_) || !seconds(record.stamp)) return false;
    } else {
      falls_ += record.frame.stamp < last_;
      stays_ += record.frame.stamp == last_;
    }
    ++lines_;
    last_ = record.frame.stamp;
    return true;
  }

  std::size_t lines() const { return lines_; }
  CandumpStamp kind() const { return kind_; }
  Time first() const { return first_; }
  const std::string& place() const { return place_; }

  // Times since the first frame hardly ever fall or stay; times since the last one do all the time.
  LogClock clock() const {
    if (!relative_) return LogClock::kRecordings;
    const std::size_t steps = lines_ - 1;
    if (100 * falls_ < steps && 2 * stays_ < steps) return LogClock::kFromFirst;
    if (steps <= 1) return LogClock::kFromFirst;  // the same
    if (20 * falls_ >= steps || 2 * stays_ >= steps) return LogClock::kFromLast;
    return LogClock::kUnclear;
  }

 private:
  std::size_t lines_ = 0;
  CandumpStamp kind_ = CandumpStamp::kNone;
  Time first_;
  Time last_;
  std::string place_;
  bool relative_ = false;
  std::size_t falls_ = 0;
  std::size_t stays_ = 0;
};

Error refuse(const LogStamps& stamps, const char* what) {
  return {stamps.place() + ": " + what +
          "; expected the clock of the recording's frames: record with candump -L"};
}

class Reader {
 public:
  Reader(const std::string& interface, std::optional<Time> start)
      : interface_(interface), start_(start) {}

  Status add(const InputLines& file, std::string_view line) {
    std::string plain;
    if (line.find('\x1b') != std::string_view::npos) line = plain = without_colours(line);
    const CandumpRecord record = parse_candump(line);
    const bool stamped = record.line != CandumpLine::kEmpty &&
                         record.line != CandumpLine::kDropped &&
                         record.line != CandumpLine::kMalformed;
    if (record.line == CandumpLine::kMalformed || (stamped && !stamps_.add(record, file))) {
      if (log_.malformed++ > 0) return {};
      log_.first_malformed = file.place();
      log_.malformed_text = printable_start(line, 80);
      return {};
    }
    if (stamped && record.stamp == CandumpStamp::kFewSeconds && offset_ < kLongest) {
      offset_ = offset_ + std::min(Duration{record.frame.stamp.ns}, kLongest);
    }
    switch (record.line) {
      case CandumpLine::kFrame:
        return add_frame(file, record);
      case CandumpLine::kFd:
        ++log_.fd_frames;
        break;
      case CandumpLine::kDropped:
        ++log_.drop_reports;
        break;
      case CandumpLine::kRemote:
      case CandumpLine::kError:
        ++log_.other_frames;
        break;
      case CandumpLine::kEmpty:
      case CandumpLine::kMalformed:
        break;
    }
    return {};
  }

  // Puts the frames on the clock of the recording.
  Result<CanLog> finish() {
    if (stamps_.lines() == 0) return std::move(log_);
    if (stamps_.kind() == CandumpStamp::kNone) {
      return refuse(stamps_, "the frames have no stamps, so that nothing tells when they came");
    }
    const LogClock clock = stamps_.clock();
    if (clock == LogClock::kUnclear) {
      return refuse(stamps_,
                    "the stamps neither rise as those of candump -tz nor jump as those of "
                    "candump -td");
    }
    if (clock != LogClock::kRecordings && !start_) {
      return refuse(stamps_, clock == LogClock::kFromLast
                                 ? "the stamps count from the frame before (candump -td), and "
                                   "odometry.log_start_s does not say when the first one came"
                                 : "the stamps count from the first frame (candump -tz), and "
                                   "odometry.log_start_s does not say when that came");
    }
    log_.local_dates = stamps_.kind() == CandumpStamp::kLocalDate && !start_;
    if (!start_) return std::move(log_);
    for (std::size_t i = 0; i < log_.frames.size(); ++i) {
      Time& stamp = log_.frames[i].stamp;
      const Duration since =
          clock == LogClock::kFromLast ? since_first_[i] : stamp - stamps_.first();
      stamp = std::max(*start_ + std::clamp(since, Duration{-kLongest.ns}, kLongest), Time{0});
    }
    return std::move(log_);
  }

 private:
  Status add_frame(const InputLines& file, const CandumpRecord& record) {
    if (!record.interface.empty() && record.interface != interface_) {
      ++log_.other_interfaces;
      return {};
    }
    if (log_.frames.size() == kMaxLoggedFrames) {
      return file.error("expected at most " + std::to_string(kMaxLoggedFrames) + " frames of " +
                        interface_ + "; record a long drive in parts");
    }
    log_.frames.push_back(record.frame);
    if (record.stamp == CandumpStamp::kFewSeconds) since_first_.push_back(offset_);
    return {};
  }

  std::string interface_;
  std::optional<Time> start_;
  CanLog log_;
  LogStamps stamps_;
  Duration offset_;                    // the sum of the stamps so far, for -td
  std::vector<Duration> since_first_;  // of each frame, if the stamps are those of -td
};

}  // namespace

Result<CanLog> parse_can_log(InputLines& file, const std::string& interface,
                             std::optional<Time> start) {
  Reader reader(interface, start);
  std::string_view line;
  while (file.next(line)) {
    if (const Status added = reader.add(file, line); !added) return added.error();
  }
  if (!file.status()) return file.status().error();
  return reader.finish();
}

Result<CanLog> read_can_log(const std::filesystem::path& path, const std::string& interface,
                            std::optional<Time> start) {
  auto file = InputLines::open(path.string(), kLimits);
  if (!file) return file.error();
  return parse_can_log(*file, interface, start);
}

}  // namespace zenith
