#pragma once
// The log of the daemon: lines on stderr for a person, or entries with fields for journald.
//
// Every thread may log, also one with deadlines: a line is formatted on the caller's stack and goes
// through a bounded queue; no lock, no heap, no system call but the clock's. One thread without
// deadlines calls drain(), which writes. What does not fit is counted and told.
//
// A message's site is its format string: keep to literals. Each site may log kBurst lines in
// kWindow; what exceeds that is counted, and told when the window is over.
//
// Lines that belong together, such as all mistakes of a file, are one report (write_report()): it
// is told whole. Its site is its text: kBurst times the same one in kWindow, then it is left out
// whole.

#include <array>
#include <atomic>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "platform/base/time.h"
#include "platform/linux/journal.h"
#include "platform/linux/log_fields.h"
#include "platform/linux/mpsc_queue.h"

namespace zenith {

// The numbers are syslog's.
enum class LogLevel : std::uint8_t { kError = 3, kWarning = 4, kNotice = 5, kInfo = 6, kDebug = 7 };

enum class LogStyle {
  kJournal,  // "<4>text": journald makes the priority of it and stamps by itself
  kPerson,   // "2026-03-01 12:34:56.789 warning: text"
};

struct LogCounters {
  std::uint64_t lost = 0;         // the queue was full
  std::uint64_t suppressed = 0;   // by the rate limit
  std::uint64_t not_written = 0;  // stderr did not take the line in time
};

class Log {
 public:
  static constexpr std::size_t kTextBytes = 232;  // longer texts are cut and end in "..."
  static constexpr std::size_t kQueued = 256;
  static constexpr std::size_t kSites = 128;  // further ones have no rate limit
  static constexpr std::uint32_t kBurst = 10;
  static constexpr std::size_t kReportLines = 128;  // of one report; how many follow is its last
  static constexpr std::size_t kReports = 32;       // different ones in kWindow
  static constexpr Duration kWindow = {10'000'000'000};
  // A reader that does not read may hold up drain() for so long, once; its lines are then dropped
  // until it reads again.
  static constexpr Duration kWriteLimit = {200'000'000};

  // `fd` stays the caller's.
  Log(int fd, LogStyle style) : fd_(fd), style_(style) {}

  // From now on entries with fields go to the journal; lines to `fd` only when it takes them not.
  // Before other threads log, as name_robot().
  void use_journal(const std::string& socket) { journal_ = JournalSocket(socket); }
  // ZENITH_ROBOT of all entries.
  void name_robot(std::string_view name) { robot_.assign(name); }

  // Less important lines are dropped at once. At first kInfo.
  void set_level(LogLevel least) { least_.store(least, std::memory_order_relaxed); }
  bool would_log(LogLevel level) const { return level <= least_.load(std::memory_order_relaxed); }

  // Any thread. printf's formats, without precisions in the hundreds (glibc then allocates). What
  // a terminal must not get is written as an escape (platform/base/printable.h).
  void write(LogLevel level, const char* format, ...) __attribute__((format(printf, 3, 4)));
  void write(LogLevel level, Time now, const LogFields& fields, const char* format,
             va_list arguments) __attribute__((format(printf, 5, 0)));

  // Threads without deadlines: takes a lock. A line of `text` that is too long becomes several; the
  // first bears `fields`.
  void write_report(LogLevel level, Time now, const LogFields& fields, std::string_view text);

  // One thread: writes what is queued, tells what was lost or suppressed. Returns how many lines.
  std::size_t drain(Time now);

  LogCounters counters() const;

 private:
  struct Record {
    std::array<char, kTextBytes> text;
    LogLevel level = LogLevel::kInfo;
    LogFields fields;
  };
  // How often a format was logged in its window. All fields are atomics of their own: figures of a
  // site that two threads use at the same moment may be off by a line.
  struct Site {
    std::atomic<const char*> format = nullptr;
    std::atomic<std::int64_t> window_start_ns = 0;
    std::atomic<std::uint32_t> lines = 0;
    std::atomic<std::uint32_t> suppressed = 0;  // in this window
    std::atomic<std::uint32_t> to_tell = 0;     // in windows that are over
    std::atomic<LogLevel> level = LogLevel::kInfo;
  };

  // How often a report was logged in its window.
  struct ReportSite {
    std::uint64_t text_hash = 0;
    Time window_start;
    std::uint32_t times = 0;  // 0: the site is free
    std::uint32_t suppressed = 0;
    LogLevel level = LogLevel::kInfo;
    FixedText<80> beginning;
  };

  Site* site_of(const char* format);
  bool passes(LogLevel level, const char* format, Time now);
  bool report_passes(LogLevel level, std::string_view text, Time now);
  void tell_suppressed(Time now);
  void tell_suppressed_reports(Time now);
  void put_left_out(LogLevel level, std::uint32_t count, const char* what);
  void tell_lost();
  void put(LogLevel level, const char* text, const LogFields& fields);
  bool put_entry(LogLevel level, const char* text, const LogFields& fields) const;
  bool put_bytes(const char* bytes, std::size_t count);

  const int fd_;
  const LogStyle style_;
  JournalSocket journal_;
  FixedText<63> robot_;
  std::atomic<LogLevel> least_ = LogLevel::kInfo;
  std::atomic<std::uint64_t> lost_ = 0;
  std::atomic<std::uint64_t> suppressed_ = 0;
  std::atomic<std::uint64_t> not_written_ = 0;
  std::uint64_t told_lost_ = 0;
  std::size_t written_ = 0;
  bool stuck_ = false;     // the reader does not read
  bool mid_line_ = false;  // it took a part of the last line
  std::array<Site, kSites> sites_ = {};
  std::mutex reports_mutex_;
  std::array<ReportSite, kReports> reports_ = {};  // under reports_mutex_
  std::uint32_t reports_without_site_ = 0;         // likewise; left out
  MpscQueue<Record, kQueued> queue_;
};

// The process's log on stderr: when that goes to journald (JOURNAL_STREAM names it), entries with
// fields through the journal's own socket.
// Made at the first call: make it before threads with deadlines start.
Log& process_log();

// Into process_log().
void log_line(LogLevel level, const char* format, ...) __attribute__((format(printf, 2, 3)));
void log_line(LogLevel level, const LogFields& fields, const char* format, ...)
    __attribute__((format(printf, 3, 4)));
// A report into process_log(): the lines of `text`, or each of `lines` after "what: ".
void log_lines(LogLevel level, std::string_view text);
void log_lines(LogLevel level, const LogFields& fields, std::string_view text);
void log_lines(LogLevel level, std::string_view what, const std::vector<std::string>& lines);

// Whether `journal_stream` ("device:inode", or nullptr) names the file that `fd` is.
bool is_journal(int fd, const char* journal_stream);

}  // namespace zenith
