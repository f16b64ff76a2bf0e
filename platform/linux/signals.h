#pragma once
// Signals that ask the daemon for something, as a file descriptor: no handler, no interruption of
// any thread's calls.

#include <optional>

#include "platform/base/result.h"
#include "platform/base/time.h"
#include "platform/linux/unique_fd.h"

namespace zenith {

enum class SignalRequest {
  kStop,    // SIGTERM, SIGINT
  kReload,  // SIGHUP
};

// Blocks SIGTERM, SIGINT and SIGHUP in the calling thread and all that it starts afterwards, and
// ignores SIGPIPE: to be called first of all in main(). Threads that libraries started earlier hand
// them on.
class Signals {
 public:
  Status open();

  // Waits up to `timeout` (0: not at all). The thread that called open().
  std::optional<SignalRequest> wait(Duration timeout);

  // Readable when a request waits; for a poll() beside other descriptors.
  int fd() const { return fd_.get(); }

 private:
  UniqueFd fd_;
};

}  // namespace zenith
