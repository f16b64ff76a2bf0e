#include "platform/daemon/daemon_threads.h"

#include <unistd.h>

#include <cassert>
#include <exception>
#include <string_view>
#include <utility>

#include "platform/linux/clock.h"
#include "platform/linux/log.h"

namespace zenith {
namespace {

#if defined(__SANITIZE_THREAD__)
constexpr std::size_t kStack = std::size_t{4096} * 1024;  // the sanitizer keeps its own there, too
#else
constexpr std::size_t kStack = std::size_t{512} * 1024;
#endif
constexpr Duration kLook = {2'000'000};

}  // namespace

DaemonThreads::~DaemonThreads() {
  tell_to_stop();
  const Time limit = monotonic_now() + kLastLimit;
  while (!running().empty() && monotonic_now() < limit) sleep_until(monotonic_now() + kLook);
  const std::string left = running();
  if (left.empty()) return;  // the threads' destructors join
  log_line(LogLevel::kError, "left behind: %s", left.c_str());
  process_log().drain(monotonic_now());
  ::_exit(1);
}

bool DaemonThreads::start(ThreadOptions options, const char* name, Body body, Report& report) {
  assert(count_ < kMost);
  options.name = name;
  options.stack_bytes = kStack;
  Slot& slot = slots_[count_];
  slot.name = name;
  const Status started = slot.thread.start(
      options, [this, &slot, body = std::move(body)] { run(slot, body); }, report);
  if (!started) {
    log_lines(LogLevel::kError, started.error().message);
    return false;
  }
  ++count_;
  return true;
}

void DaemonThreads::run(Slot& slot, const Body& body) {
  try {
    body(stop_);
  } catch (const std::exception& error) {
    log_line(LogLevel::kError, LogFields("failed"), "thread %s ended by an error: %s", slot.name,
             error.what());
    failed_.store(true, std::memory_order_release);
  }
  slot.ended.store(true, std::memory_order_release);
}

bool DaemonThreads::ended(const char* name) const {
  for (std::size_t i = 0; i < count_; ++i) {
    if (std::string_view(slots_[i].name) != name) continue;
    return slots_[i].ended.load(std::memory_order_acquire);
  }
  return true;
}

std::string DaemonThreads::running() const {
  std::string names;
  for (std::size_t i = 0; i < count_; ++i) {
    if (ended(slots_[i].name)) continue;
    names += (names.empty() ? "" : ", ") + std::string(slots_[i].name);
  }
  return names;
}

}  // namespace zenith
