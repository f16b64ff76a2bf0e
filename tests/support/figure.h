#pragma once
// Figures that a test measured. `./dev test` shows the lines after the summary, passed or not.

#include <cstdarg>
#include <cstdio>

namespace zenith {

// One line, printf's way: print_figure("robot %d: %.3f m", robot, error_m).
[[gnu::format(printf, 1, 2)]] inline void print_figure(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  std::fputs("figure: ", stdout);
  std::vprintf(format, arguments);
  std::fputc('\n', stdout);
  std::fflush(stdout);
  va_end(arguments);
}

}  // namespace zenith
