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

// But what a library, such as a profiler's, has taken for itself.
void ignore_what_nobody_asked_for() {
  const sigset_t ignored = ignored_signals();
  for (int signal = 1; signal <= SIGRTMAX; ++signal) {
    struct sigaction before = {};
    if (sigismember(&ignored, signal) != 1 || sigaction(signal, nullptr, &before) != 0) continue;
    if (before.sa_handler == SIG_DFL) std::signal(signal, SIG_IGN);
  }
}

}  // namespace

sigset_t ignored_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGPIPE, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGIO, SIGPWR,
                           SIGSTKFLT, SIGXFSZ}) {
    sigaddset(&set, signal);
  }
  for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) sigaddset(&set, signal);
  return set;
}

Status Signals::open(SignalRequest hang_up) {
  sigset_t set;
  sigemptyset(&set);
  receiver = static_cast<pid_t>(syscall(SYS_gettid));
  hang_up_ = hang_up;
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
    struct sigaction before = {};
    sigaction(signal, nullptr, &before);
    const bool is_ignored = before.sa_handler == SIG_IGN;  // as nohup and a shell's & want it
    // Blocked, it would come all the same.
    if (is_ignored && signal == SIGHUP && hang_up == SignalRequest::kStop) continue;
    sigaddset(&set, signal);
    if (is_ignored) continue;
    struct sigaction action = {};
    action.sa_handler = hand_on;
    action.sa_flags = SA_RESTART;
    sigaction(signal, &action, nullptr);
  }
  int error = pthread_sigmask(SIG_BLOCK, &set, nullptr);
  if (error == 0) {
    ignore_what_nobody_asked_for();
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
  return info.ssi_signo == SIGHUP ? hang_up_ : SignalRequest::kStop;
}

}  // namespace zenith
