#include "platform/linux/clock.h"

#include <cerrno>
#include <cstdio>
#include <ctime>

namespace zenith {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::int64_t read_ns(clockid_t clock) {
  timespec now = {};
  clock_gettime(clock, &now);
  return now.tv_sec * kSecond_ns + now.tv_nsec;
}

}  // namespace

Time monotonic_now() {
  return {read_ns(CLOCK_MONOTONIC)};
}

Duration thread_cpu_time() {
  return {read_ns(CLOCK_THREAD_CPUTIME_ID)};
}

Duration system_clock_offset() {
  const std::int64_t before = read_ns(CLOCK_MONOTONIC);
  const std::int64_t system = read_ns(CLOCK_REALTIME);
  const std::int64_t after = read_ns(CLOCK_MONOTONIC);
  return {system - (before + (after - before) / 2)};
}

void sleep_until(Time wake) {
  if (wake.ns <= 0) return;
  timespec until = {};
  until.tv_sec = static_cast<time_t>(wake.ns / kSecond_ns);
  until.tv_nsec = static_cast<long>(wake.ns % kSecond_ns);
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

std::string wall_clock_text() {
  timespec now = {};
  clock_gettime(CLOCK_REALTIME, &now);
  std::tm utc = {};
  gmtime_r(&now.tv_sec, &utc);
  char text[64];
  const std::size_t used = std::strftime(text, sizeof(text), "%F %T", &utc);
  std::snprintf(text + used, sizeof(text) - used, ".%03d", static_cast<int>(now.tv_nsec / 1000000));
  return text;
}

}  // namespace zenith
