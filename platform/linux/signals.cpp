#include "platform/linux/signals.h"

#include <poll.h>
#include <pthread.h>
#include <sys/signalfd.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

pid_t receiver = 0;  // the thread that called open(), where the signals wait to be read

// Threads that libraries started before main(), such as OpenBLAS's, do not block the signals:
// without this the kernel would hand them one, and it would end the process.
void hand_on(int signal) {
  const int error = errno;
  syscall(SYS_tgkill, getpid(), receiver, signal);
  errno = error;
}

}  // namespace

Status Signals::open() {
  sigset_t set;
  sigemptyset(&set);
  receiver = static_cast<pid_t>(syscall(SYS_gettid));
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
    sigaddset(&set, signal);
    struct sigaction before = {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler == SIG_IGN) continue;  // as nohup and a shell's & want it
    struct sigaction action = {};
    action.sa_handler = hand_on;
    action.sa_flags = SA_RESTART;
    sigaction(signal, &action, nullptr);
  }
  int error = pthread_sigmask(SIG_BLOCK, &set, nullptr);
  if (error == 0) {
    std::signal(SIGPIPE, SIG_IGN);
    fd_.reset(signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK));
    if (fd_.is_open()) return {};
    error = errno;
  }
  return Error{"signals cannot be received: " + errno_text(error) +
               "; the kernel must have signalfd, and the process a file descriptor left"};
}

std::optional<SignalRequest> Signals::wait(Duration timeout) {
  pollfd poll_fd = {fd_.get(), POLLIN, 0};
  const timespec limit = {static_cast<time_t>(timeout.ns / 1'000'000'000),
                          static_cast<long>(timeout.ns % 1'000'000'000)};
  if (::ppoll(&poll_fd, 1, &limit, nullptr) != 1) return std::nullopt;
  signalfd_siginfo info = {};
  if (::read(fd_.get(), &info, sizeof(info)) != sizeof(info)) return std::nullopt;
  return info.ssi_signo == SIGHUP ? SignalRequest::kReload : SignalRequest::kStop;
}

}  // namespace zenith
