#pragma once
// A thread with what a deadline needs: a stack of known size, a name, CPUs, a realtime priority.

#include <pthread.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "platform/base/result.h"
#include "platform/linux/realtime.h"

namespace zenith {

struct ThreadOptions {
  std::string name;  // at most 15 bytes, as ps and top show it
  std::size_t stack_bytes = std::size_t{256} * 1024;
  // 1..99: SCHED_FIFO, taken by the thread itself after its start, so that no other thread inherits
  // it. 0: normal scheduling.
  int fifo_priority = 0;
  std::uint64_t cpus = 0;  // bit n: CPU n. 0: any.
};

class Thread {
 public:
  Thread() = default;
  Thread(const Thread&) = delete;
  Thread& operator=(const Thread&) = delete;
  ~Thread() { join(); }

  // Returns when the thread has set itself up; `body` then runs in it. A priority or CPUs that the
  // kernel does not grant are told in `report` and the thread runs without. An error means that it
  // does not run at all. Not while it runs already.
  Status start(const ThreadOptions& options, std::function<void()> body, Report& report);

  // Waits until the body has returned. Telling it to is the owner's business.
  void join();
  bool running() const { return running_; }  // started and not joined

 private:
  pthread_t thread_ = {};
  bool running_ = false;
};

}  // namespace zenith
