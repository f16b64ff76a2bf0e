#include "tools/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "platform/linux/printable_output.h"

namespace zenith::tools {
namespace {

constexpr double kQuietSeconds = 2.0;

std::string clock_text(double seconds) {
  const int whole = static_cast<int>(std::clamp(seconds, 0.0, 359999.0) + 0.5);
  char text[24];
  if (whole >= 3600) {
    std::snprintf(text, sizeof text, "%d:%02d:%02d", whole / 3600, whole / 60 % 60, whole % 60);
  } else {
    std::snprintf(text, sizeof text, "%d:%02d", whole / 60, whole % 60);
  }
  return text;
}

}  // namespace

Progress::Progress(std::string title)
    : title_(std::move(title)),
      start_(Clock::now()),
      drawn_(start_),
      terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (!visible_) return;
  const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
  if (terminal_) {
    draw_line(fraction_, elapsed);
    std::fputc('\n', stderr);
  } else {
    std::fprintf(stderr, "%s: %.0f %% after %s\n", title_.c_str(), 100.0 * fraction_,
                 clock_text(elapsed).c_str());
  }
}

void Progress::update(double fraction) {
  const std::scoped_lock lock(mutex_);
  fraction_ = std::clamp(fraction, fraction_, 1.0);
  const auto now = Clock::now();
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  if (elapsed < kQuietSeconds) return;
  if (terminal_) {
    if (visible_ && now - drawn_ < std::chrono::milliseconds(100)) return;
    draw_line(fraction_, elapsed);
  } else {
    const int tenths = static_cast<int>(fraction_ * 10.0);
    if (tenths <= tenths_ || tenths >= 10) return;
    tenths_ = tenths;
    std::fprintf(stderr, "%s: %.0f %%, %s to go\n", title_.c_str(), 100.0 * fraction_,
                 clock_text(elapsed * (1.0 - fraction_) / std::max(fraction_, 1e-6)).c_str());
  }
  visible_ = true;
  drawn_ = now;
}

void Progress::draw_line(double fraction, double elapsed_s) {
  constexpr int kWidth = 32;
  const int filled = static_cast<int>(fraction * kWidth);
  std::string bar(static_cast<std::size_t>(filled), '#');
  bar.resize(kWidth, '.');
  const bool done = fraction >= 1.0;
  const double left = elapsed_s * (1.0 - fraction) / std::max(fraction, 1e-6);
  char line[160];
  std::snprintf(line, sizeof line, "\r%-24s [%s] %3.0f %%  %s %s   ", title_.c_str(), bar.c_str(),
                100.0 * fraction, clock_text(done ? elapsed_s : left).c_str(),
                done ? "in all " : "to go  ");
  write_to_terminal(line);
}

}  // namespace zenith::tools
