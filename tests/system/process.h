#pragma once
// A program under test, and what a service manager hears of it.

#include <fcntl.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "platform/linux/clock.h"
#include "tests/support/patience.h"

namespace zenith {

// Waits in small steps until `holds`; false after `limit_s`.
template <typename Holds>
bool wait_until(double limit_s, Holds holds) {
  const Time limit = monotonic_now() + Duration::from_seconds(limit_s);
  while (!holds()) {
    if (monotonic_now() > limit) return false;
    sleep_until(monotonic_now() + Duration{10'000'000});
  }
  return true;
}

// The service manager's socket.
class NotifySocket {
 public:
  explicit NotifySocket(const std::string& path)
      : fd_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    sockaddr_un address = {};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.data(), path.size());
    bound_ = ::bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  ~NotifySocket() { ::close(fd_); }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  bool bound() const { return bound_; }
  // Whether a message that begins so came, now or earlier; messages before it are forgotten.
  bool heard(const std::string& beginning, double limit_s) {
    return wait_until(limit_s, [&] {
      std::array<char, 1024> text;
      ssize_t length = 0;
      while ((length = ::recv(fd_, text.data(), text.size(), 0)) > 0) {
        const std::string message(text.data(), static_cast<std::size_t>(length));
        if (message.compare(0, beginning.size(), beginning) == 0) return true;
      }
      return false;
    });
  }

 private:
  int fd_;
  bool bound_ = false;
};

struct Environment {
  const char* name;
  std::string value;
};

class Process {
 public:
  // Standard error goes to the file `errors`, standard output to `output`.
  Process(const std::vector<std::string>& words, const std::string& output,
          const std::string& errors, const std::vector<Environment>& environment = {}) {
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ != 0) return;
    (void)::setpgid(0, 0);
    for (const Environment& e : environment) ::setenv(e.name, e.value.c_str(), 1);
    ::dup2(::open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
    ::dup2(::open(errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
  }
  ~Process() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t pid() const { return pid_; }
  void send(int signal) const { ::kill(pid_, signal); }
  // To what it has started, too.
  void send_group(int signal) const { ::kill(-pid_, signal); }

  // The exit code, as a shell has it: 128 and the signal when it was killed; -1 when it does not
  // end in time.
  int wait(double limit_s) {
    int status = 0;
    const bool ended =
        wait_until(limit_s, [&] { return ::waitpid(pid_, &status, WNOHANG) == pid_; });
    if (!ended) return -1;
    pid_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  pid_t pid_ = 0;
};

}  // namespace zenith
