#pragma once
// A progress bar on stderr. On a terminal: one line, rewritten, with the time that remains. Else:
// a line about every ten percent. Nothing at all when the work ends within two seconds.

#include <chrono>
#include <mutex>
#include <string>

namespace zenith::tools {

class Progress {
 public:
  explicit Progress(std::string title);
  // Ends the line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // May be called from several threads, and often: it draws at most ten times a second.
  void update(double fraction);

 private:
  using Clock = std::chrono::steady_clock;

  void draw_line(double fraction, double elapsed_s);

  std::mutex mutex_;
  std::string title_;
  Clock::time_point start_;
  Clock::time_point drawn_;
  bool terminal_;
  bool visible_ = false;
  int tenths_ = 0;
  double fraction_ = 0.0;
};

}  // namespace zenith::tools
