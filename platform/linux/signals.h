#pragma once
// Signals that ask the daemon for something, as a file descriptor: no handler, no interruption of
// any thread's calls.

#include <signal.h>

#include <optional>

#include "platform/base/result.h"
#include "platform/base/time.h"
#include "platform/linux/unique_fd.h"

namespace zenith {

enum class SignalRequest {
  kStop,    // SIGTERM, SIGINT
  kReload,  // SIGHUP of a service
};

// First of all in main(): until open() returns each of these signals ends the program. Blocks
// SIGTERM, SIGINT and SIGHUP in the calling thread and all that it starts afterwards, and ignores
// the others that would end a program of which nobody asked for it (ignored_signals()). Threads
// that libraries started earlier hand them on. Those of a fault (SIGSEGV, SIGABRT, SIGQUIT) and of
// a limit of time stay.
class Signals {
 public:
  // `hang_up`: what SIGHUP asks for. kStop: the terminal is gone; nohup still keeps it away.
  Status open(SignalRequest hang_up = SignalRequest::kStop);

  // Waits up to `timeout` (0: not at all). The thread that called open().
  std::optional<SignalRequest> wait(Duration timeout);

  // Readable when a request waits; for a poll() beside other descriptors.
  int fd() const { return fd_.get(); }

 private:
  UniqueFd fd_;
  SignalRequest hang_up_ = SignalRequest::kStop;
};

// SIGPIPE, and those of timers, users and power that no program here uses.
sigset_t ignored_signals();

}  // namespace zenith
