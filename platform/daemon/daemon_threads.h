#pragma once
// The daemon's threads and how they end: told, waited for, or left behind.
//
// A thread that does not end in time, such as one inside a driver, is left behind: then the process
// may end by _exit() alone, for what the thread uses must stay. What escapes a thread's body as an
// exception is logged and ends the daemon in good order.

#include <array>
#include <atomic>
#include <functional>
#include <string>

#include "platform/base/time.h"
#include "platform/linux/thread.h"

namespace zenith {

class DaemonThreads {
 public:
  DaemonThreads() = default;
  // Tells all to stop. With one that does not end within kLastLimit the process ends here.
  ~DaemonThreads();
  DaemonThreads(const DaemonThreads&) = delete;
  DaemonThreads& operator=(const DaemonThreads&) = delete;

  using Body = std::function<void(const std::atomic<bool>& stop)>;
  // False, and logged, when it does not start. Names are literals.
  bool start(ThreadOptions options, const char* name, Body body, Report& report);

  void tell_to_stop() { stop_.store(true, std::memory_order_relaxed); }
  // Also true when it was never started.
  bool ended(const char* name) const;
  // Those that have not ended: "zen-keeper, zen-tap"; empty: none.
  std::string running() const;
  // An exception ended one of them.
  bool failed() const { return failed_.load(std::memory_order_acquire); }

 private:
  static constexpr Duration kLastLimit = {5'000'000'000};
  static constexpr std::size_t kMost = 6;
  struct Slot {
    const char* name = "";
    std::atomic<bool> ended = false;
    Thread thread;
  };

  void run(Slot& slot, const Body& body);

  std::atomic<bool> stop_ = false;
  std::atomic<bool> failed_ = false;
  std::array<Slot, kMost> slots_;
  std::size_t count_ = 0;
};

}  // namespace zenith
