#include "tools/clocks/alignment.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

#include "tools/doctor/formatted.h"

namespace zenith::tools {
namespace {

// Stamps after September 2001 are wall time: no computer runs for 30 years.
constexpr Time kEpochLike = {1'000'000'000'000'000'000};
constexpr double kMostStated_s = 2e9;  // 63 years

bool looks_like_wall(const RecordedSpan& r) {
  return r.first >= kEpochLike;
}

// "2026-03-01 12:34:56.8" UTC, or seconds of another clock.
std::string time_text(Time time, bool wall) {
  if (!wall) return formatted("%.1f", Duration{time.ns}.seconds());
  const auto seconds = static_cast<std::time_t>(time.ns / 1'000'000'000);
  std::tm utc = {};
  gmtime_r(&seconds, &utc);
  char text[40];
  const std::size_t used = std::strftime(text, sizeof text, "%F %T", &utc);
  return std::string(text, used) +
         formatted(".%d", static_cast<int>(time.ns % 1'000'000'000 / 100'000'000));
}

ClockShift by_clock(const ClockLog& clock) {
  const auto& readings = clock.readings();
  ClockShift shift(clock.offset(readings.front().monotonic));
  for (const ClockReading& r : readings) {
    const Duration offset = clock.offset(r.monotonic);
    if (offset != shift.pieces().back().offset) shift.add(r.monotonic, offset);
  }
  return shift;
}

void tell_clock(const RecordedSpan& r, std::vector<std::string>& warnings) {
  if (!r.clock->synchronised()) {
    warnings.push_back(r.name +
                       ": the wall clock was not synchronised (NTP) while it recorded; "
                       "where the recording lies against the others is as right as that "
                       "clock; --offset " +
                       r.name + "=SECONDS corrects it");
  }
  if (const double step_s = r.clock->stepped().seconds(); step_s != 0.0) {
    warnings.push_back(
        r.name + formatted(": the wall clock was set by %+.3f s while it recorded; ", step_s) +
        "what it said afterwards is taken for all of the recording");
  }
  if (const double slept_s = r.clock->slept().seconds(); slept_s >= 0.001) {
    warnings.push_back(r.name +
                       formatted(": the computer slept for %.1f s while it recorded; ", slept_s) +
                       "stamps after that are later by as much");
  }
}

struct Shifted {
  Time first;
  Time last;
};

class Aligner {
 public:
  Aligner(const std::vector<RecordedSpan>& recordings, const AlignOptions& options)
      : recordings_(recordings), options_(options) {}

  Result<Alignment> run() {
    for (const auto& [name, offset] : options_.stated_s) {
      if (std::none_of(recordings_.begin(), recordings_.end(),
                       [&name = name](const RecordedSpan& r) { return r.name == name; })) {
        return Error{"--offset " + name +
                     ": expected the name of one of the recordings, found "
                     "none that is called so"};
      }
    }
    out_.shifts.resize(recordings_.size());
    choose();
    for (std::size_t i = 0; i < recordings_.size(); ++i) {
      const auto stated = options_.stated_s.find(recordings_[i].name);
      if (stated == options_.stated_s.end()) continue;
      out_.shifts[i].move(Duration::from_seconds(stated->second));
      out_.notes.push_back(recordings_[i].name +
                           formatted(": moved by %+.3f s as stated", stated->second));
    }
    for (std::size_t i = 0; i < recordings_.size(); ++i) {
      const RecordedSpan& r = recordings_[i];
      spans_.push_back({out_.shifts[i].of(r.first), out_.shifts[i].of(r.last)});
      if (spans_.back().first.ns >= 0) continue;
      return Error{r.name + formatted(": its stamps begin at %.1f s, before the clock begins; "
                                      "state smaller offsets, or larger ones of the others",
                                      Duration{spans_.back().first.ns}.seconds())};
    }
    for (std::size_t i = 0; i < spans_.size(); ++i) {
      for (std::size_t k = i + 1; k < spans_.size(); ++k) compare(i, k);
    }
    return std::move(out_);
  }

 private:
  void choose() {
    if (recordings_.size() < 2 || options_.by == AlignBy::kRecorded) return;
    if (options_.by == AlignBy::kStart) {
      for (std::size_t i = 1; i < recordings_.size(); ++i) {
        out_.shifts[i].move(recordings_[0].first - recordings_[i].first);
      }
      out_.notes.emplace_back("clocks: all recordings begin together, as asked");
      return;
    }
    std::string without;
    bool any = false;
    for (const RecordedSpan& r : recordings_) {
      any = any || r.clock || looks_like_wall(r);
      if (!r.clock && !looks_like_wall(r)) without += (without.empty() ? "" : ", ") + r.name;
    }
    if (without.empty()) return take_clocks();
    if (!any) {
      out_.notes.emplace_back(
          "clocks: none of the recordings says where its clock lies (clock.csv); taken as one");
      return;
    }
    out_.warnings.push_back(without +
                            ": without clock.csv; all recordings are taken as stamped by "
                            "one clock, whatever the others' clock.csv says");
  }

  void take_clocks() {
    bool all_stamped = true;
    for (std::size_t i = 0; i < recordings_.size(); ++i) {
      const RecordedSpan& r = recordings_[i];
      if (!r.clock) continue;
      all_stamped = false;
      out_.shifts[i] = by_clock(*r.clock);
      tell_clock(r, out_.warnings);
    }
    out_.wall = true;
    out_.notes.emplace_back(all_stamped ? "clocks: all stamps are wall time"
                                        : "clocks: on wall time by clock.csv");
  }

  void compare(std::size_t i, std::size_t k) {
    const Shifted& a = spans_[i];
    const Shifted& b = spans_[k];
    const std::string& first = recordings_[i].name;
    const std::string& second = recordings_[k].name;
    const double common_s = (std::min(a.last, b.last) - std::max(a.first, b.first)).seconds();
    if (common_s >= 0.0) {
      out_.notes.push_back(first + " and " + second +
                           formatted(": %.1f s in common, of %.1f s and %.1f s", common_s,
                                     (a.last - a.first).seconds(), (b.last - b.first).seconds()));
      return;
    }
    out_.disjoint = true;
    const bool a_first = a.last < b.first;
    std::string text = first + " (" + span_text(a) + ") and " + second + " (" + span_text(b) +
                       ") have no time in common: " + (a_first ? second : first) +
                       formatted(" begins %.1f s after the end of ", -common_s) +
                       (a_first ? first : second);
    if (out_.wall) {
      text += ", by their clocks; they are mapped one after the other";
    } else {
      out_.unexplained = true;
      text +=
          "; each may be stamped by a clock that began at its own computer's start. They are "
          "mapped one after the other. When they were recorded together: --align start, or "
          "--offset " +
          second + "=SECONDS, what is to be added to its stamps";
    }
    out_.warnings.push_back(text);
  }

  std::string span_text(const Shifted& s) const {
    return time_text(s.first, out_.wall) + " .. " + time_text(s.last, out_.wall) +
           (out_.wall ? " UTC" : " s");
  }

  const std::vector<RecordedSpan>& recordings_;
  const AlignOptions& options_;
  std::vector<Shifted> spans_;
  Alignment out_;
};

}  // namespace

Result<std::pair<std::string, double>> parse_stated_offset(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  char* end = nullptr;
  const std::string number = equals == std::string::npos ? "" : text.substr(equals + 1);
  const double value = std::strtod(number.c_str(), &end);
  if (equals == 0 || number.empty() || *end != '\0' || !(std::abs(value) <= kMostStated_s)) {
    return Error{"expected ROBOT=SECONDS such as robot-2=12.5, found '" + text + "'"};
  }
  return std::pair(text.substr(0, equals), value);
}

Time ClockShift::of(Time stamp) const {
  auto piece = std::upper_bound(pieces_.begin() + 1, pieces_.end(), stamp,
                                [](Time t, const Piece& p) { return t < p.from; });
  Time moved;
  if (!__builtin_add_overflow(stamp.ns, (piece - 1)->offset.ns, &moved.ns)) return moved;
  return {std::numeric_limits<std::int64_t>::max()};
}

bool ClockShift::is_none() const {
  return std::all_of(pieces_.begin(), pieces_.end(),
                     [](const Piece& p) { return p.offset == Duration{}; });
}

Result<Alignment> align(const std::vector<RecordedSpan>& recordings, const AlignOptions& options) {
  return Aligner(recordings, options).run();
}

}  // namespace zenith::tools
