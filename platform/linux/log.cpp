#include "platform/linux/log.h"

#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string_view>

#include "platform/base/printable.h"
#include "platform/linux/clock.h"

namespace zenith {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;

const char* level_name(LogLevel level) {
  switch (level) {
    case LogLevel::kError:
      return "error";
    case LogLevel::kWarning:
      return "warning";
    case LogLevel::kNotice:
      return "notice";
    case LogLevel::kInfo:
      return "info";
    case LogLevel::kDebug:
      return "debug";
  }
  return "?";
}

using Text = std::array<char, Log::kTextBytes>;

// One record is one line: what came from outside may hold line ends and control characters. `cut`:
// `raw` is the beginning of a longer text.
void make_one_line(const char* raw, bool cut, Text& text) {
  const std::span<char> room = std::span(text).first(text.size() - 1);
  text[write_printable_cut(raw, room, cut)] = '\0';
}

// The beginning of `line` that fits into `text`, up to a space where there is one. Returns how many
// bytes of the line it is.
std::size_t take_beginning(std::string_view line, Text& text) {
  const std::span<char> room = std::span(text).first(text.size() - 1);
  PrintableSize size = write_printable(line, room);
  const std::size_t space = line.substr(0, size.read + 1).rfind(' ');
  if (size.read < line.size() && space != std::string_view::npos && space > 0) {
    size = write_printable(line.substr(0, space), room);
  }
  text[size.written] = '\0';
  return size.read;
}

// FNV-1a.
std::uint64_t hash_of(std::string_view text) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3ULL;
  return hash;
}

}  // namespace

void Log::write(LogLevel level, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  write(level, monotonic_now(), {}, format, arguments);
  va_end(arguments);
}

void Log::write(LogLevel level, Time now, const LogFields& fields, const char* format,
                va_list arguments) {
  if (!would_log(level) || !passes(level, format, now)) return;
  Record record;
  record.level = level;
  record.fields = fields;
  Text raw;
  const int length = std::vsnprintf(raw.data(), raw.size(), format, arguments);
  const bool cut = length >= static_cast<int>(raw.size());
  make_one_line(length < 0 ? format : raw.data(), cut, record.text);
  if (!queue_.push(record)) lost_.fetch_add(1, kRelaxed);
}

void Log::write_report(LogLevel level, Time now, const LogFields& fields, std::string_view text) {
  if (text.empty() || !would_log(level) || !report_passes(level, text, now)) return;
  for (std::size_t lines = 0; !text.empty(); ++lines) {
    Record record;
    record.level = level;
    if (lines == 0) record.fields = fields;
    std::size_t taken = text.size();
    if (lines < kReportLines) {
      taken = take_beginning(text.substr(0, text.find('\n')), record.text);
    } else {
      const auto left = 1 + std::count(text.begin(), text.end(), '\n');
      std::snprintf(record.text.data(), kTextBytes, "and %td further lines", left);
    }
    if (!queue_.push(record)) lost_.fetch_add(1, kRelaxed);
    // What ends the line, or the space at which it was broken, is not told.
    const bool has_end = taken < text.size() && (text[taken] == '\n' || text[taken] == ' ');
    text.remove_prefix(taken + (has_end ? 1 : 0));
  }
}

bool Log::report_passes(LogLevel level, std::string_view text, Time now) {
  const std::uint64_t hash = hash_of(text);
  const std::scoped_lock lock(reports_mutex_);
  ReportSite* mine = nullptr;
  for (ReportSite& site : reports_) {
    if (site.times > 0 && site.suppressed == 0 && now - site.window_start >= kWindow) site = {};
    if (site.times > 0 && site.text_hash == hash) mine = &site;
  }
  for (ReportSite& site : reports_) {
    if (mine == nullptr && site.times == 0) mine = &site;
  }
  if (mine == nullptr) {
    ++reports_without_site_;
    suppressed_.fetch_add(1, kRelaxed);
    return false;
  }
  if (mine->times == 0) {
    *mine = {hash, now, 0, 0, level, {}};
    mine->beginning.assign(text.substr(0, text.find('\n')));
  }
  if (mine->times++ < kBurst) return true;
  ++mine->suppressed;
  suppressed_.fetch_add(1, kRelaxed);
  return false;
}

Log::Site* Log::site_of(const char* format) {
  // Literals are aligned by a few bytes at most: mix the address well.
  const std::uint64_t key = reinterpret_cast<std::uintptr_t>(format) * 0x9E3779B97F4A7C15ULL;
  const auto start = static_cast<std::size_t>(key >> 48);
  constexpr std::size_t kProbes = 8;
  for (std::size_t i = 0; i < kProbes; ++i) {
    Site& site = sites_[(start + i) % kSites];
    const char* found = site.format.load(kRelaxed);
    if (found == nullptr && site.format.compare_exchange_strong(found, format, kRelaxed)) {
      return &site;
    }
    if (found == format) return &site;
  }
  return nullptr;
}

bool Log::passes(LogLevel level, const char* format, Time now) {
  Site* site = site_of(format);
  if (site == nullptr) return true;
  std::int64_t start = site->window_start_ns.load(kRelaxed);
  const bool over = start == 0 || now.ns - start >= kWindow.ns;
  if (over && site->window_start_ns.compare_exchange_strong(start, now.ns, kRelaxed)) {
    site->lines.store(0, kRelaxed);
    site->level.store(level, kRelaxed);
    site->to_tell.fetch_add(site->suppressed.exchange(0, kRelaxed), kRelaxed);
  }
  if (site->lines.fetch_add(1, kRelaxed) < kBurst) return true;
  site->suppressed.fetch_add(1, kRelaxed);
  suppressed_.fetch_add(1, kRelaxed);
  return false;
}

std::size_t Log::drain(Time now) {
  written_ = 0;
  Record record;
  // A bound, so that writers faster than stderr do not keep the caller here.
  for (std::size_t i = 0; i < kQueued && queue_.pop(record); ++i) {
    put(record.level, record.text.data(), record.fields);
  }
  tell_lost();
  tell_suppressed(now);
  tell_suppressed_reports(now);
  return written_;
}

void Log::tell_lost() {
  const std::uint64_t lost = lost_.load(kRelaxed);
  if (lost == told_lost_) return;
  char text[kTextBytes];
  std::snprintf(text, sizeof(text), "%" PRIu64 " log lines were lost: more than %zu were waiting",
                lost - told_lost_, kQueued);
  told_lost_ = lost;
  put(LogLevel::kWarning, text, LogFields("log-lines-lost"));
}

void Log::tell_suppressed(Time now) {
  for (Site& site : sites_) {
    std::uint32_t count = site.to_tell.exchange(0, kRelaxed);
    if (now.ns - site.window_start_ns.load(kRelaxed) >= kWindow.ns) {
      count += site.suppressed.exchange(0, kRelaxed);
    }
    if (count > 0) put_left_out(site.level.load(kRelaxed), count, site.format.load(kRelaxed));
  }
}

void Log::tell_suppressed_reports(Time now) {
  const std::scoped_lock lock(reports_mutex_);
  for (ReportSite& site : reports_) {
    if (site.suppressed == 0 || now - site.window_start < kWindow) continue;
    put_left_out(site.level, site.suppressed, site.beginning.c_str());
    site = {};
  }
  if (reports_without_site_ == 0) return;
  put_left_out(LogLevel::kWarning, reports_without_site_, "too many different reports");
  reports_without_site_ = 0;
}

void Log::put_left_out(LogLevel level, std::uint32_t count, const char* what) {
  Text raw;
  const int length = std::snprintf(
      raw.data(), raw.size(), "%" PRIu32 " more lines like this were left out: %s", count, what);
  Text text;
  make_one_line(raw.data(), length >= static_cast<int>(raw.size()), text);
  put(level, text.data(), LogFields("log-lines-left-out"));
}

bool Log::put_entry(LogLevel level, const char* text, const LogFields& fields) const {
  if (!journal_.is_open()) return false;
  JournalEntry entry;
  entry.text("MESSAGE", text);
  entry.number("PRIORITY", static_cast<int>(level));
  entry.text("SYSLOG_IDENTIFIER", program_invocation_short_name);
  if (!robot_.empty()) entry.text("ZENITH_ROBOT", robot_.view());
  if (*fields.event() != '\0') entry.text("ZENITH_EVENT", fields.event());
  if (*fields.text_name() != '\0') entry.text(fields.text_name(), fields.text_value());
  for (const LogFields::Number& n : fields.numbers()) entry.number(n.name, n.value);
  return journal_.send(entry);
}

void Log::put(LogLevel level, const char* text, const LogFields& fields) {
  if (put_entry(level, text, fields)) {
    ++written_;
    return;
  }
  char line[kTextBytes + 64];
  const char* resume = mid_line_ ? "\n" : "";
  int length = 0;
  if (style_ == LogStyle::kJournal) {
    length = std::snprintf(line, sizeof(line), "%s<%d>%s\n", resume, static_cast<int>(level), text);
  } else {
    length = std::snprintf(line, sizeof(line), "%s%s %s: %s\n", resume, wall_clock_text().c_str(),
                           level_name(level), text);
  }
  if (put_bytes(line, std::min(static_cast<std::size_t>(length), sizeof(line) - 1))) {
    ++written_;
  } else {
    not_written_.fetch_add(1, kRelaxed);
  }
}

// poll() first, for the descriptor is not ours alone and is not made non-blocking: a pipe, a socket
// or a terminal that polls writable takes a line without waiting for its reader.
bool Log::put_bytes(const char* bytes, std::size_t count) {
  while (count > 0) {
    pollfd poll_fd = {fd_, POLLOUT, 0};
    const int limit_ms = stuck_ ? 0 : static_cast<int>(kWriteLimit.ns / 1'000'000);
    const int ready = ::poll(&poll_fd, 1, limit_ms);
    if (ready < 0 && errno == EINTR) continue;
    stuck_ = ready != 1 || (poll_fd.revents & POLLOUT) == 0;
    if (stuck_) return false;
    const ssize_t written = ::write(fd_, bytes, count);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes += written;
    count -= static_cast<std::size_t>(written);
    mid_line_ = count > 0;
  }
  return true;
}

LogCounters Log::counters() const {
  return {lost_.load(kRelaxed), suppressed_.load(kRelaxed), not_written_.load(kRelaxed)};
}

bool is_journal(int fd, const char* journal_stream) {
  struct stat file = {};
  if (journal_stream == nullptr || ::fstat(fd, &file) != 0) return false;
  char own[64];
  std::snprintf(own, sizeof(own), "%ju:%ju", static_cast<std::uintmax_t>(file.st_dev),
                static_cast<std::uintmax_t>(file.st_ino));
  return std::strcmp(own, journal_stream) == 0;
}

Log& process_log() {
  static const bool journal = is_journal(STDERR_FILENO, std::getenv("JOURNAL_STREAM"));
  static Log log(STDERR_FILENO, journal ? LogStyle::kJournal : LogStyle::kPerson);
  static const bool used = [] {
    if (journal) log.use_journal(kJournalSocket);
    return true;
  }();
  (void)used;
  return log;
}

void log_line(LogLevel level, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  process_log().write(level, monotonic_now(), {}, format, arguments);
  va_end(arguments);
}

void log_line(LogLevel level, const LogFields& fields, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  process_log().write(level, monotonic_now(), fields, format, arguments);
  va_end(arguments);
}

void log_lines(LogLevel level, std::string_view text) {
  process_log().write_report(level, monotonic_now(), {}, text);
}

void log_lines(LogLevel level, const LogFields& fields, std::string_view text) {
  process_log().write_report(level, monotonic_now(), fields, text);
}

void log_lines(LogLevel level, std::string_view what, const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) {
    text.append(text.empty() ? "" : "\n").append(what).append(what.empty() ? "" : ": ");
    text.append(line);
  }
  log_lines(level, text);
}

}  // namespace zenith
