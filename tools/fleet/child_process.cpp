#include "tools/fleet/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <utility>

#include "platform/linux/clock.h"
#include "platform/linux/errno_text.h"
#include "platform/linux/signals.h"

namespace zenith::tools {

ChildProcess::ChildProcess(ChildProcess&& other) noexcept : pid_(std::exchange(other.pid_, 0)) {}

ChildProcess::~ChildProcess() {
  stop();
}

namespace {

// Returns 0, or the error.
int spawn(pid_t& pid, const std::vector<std::string>& words,
          const posix_spawn_file_actions_t& actions) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  // Signals that this program blocks or ignores reach it as usual.
  sigset_t none;
  const sigset_t ignored = ignored_signals();
  ::sigemptyset(&none);
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setsigdefault(&attributes, &ignored);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  const int error =
      ::posix_spawnp(&pid, arguments[0], &actions, &attributes, arguments.data(), environ);
  ::posix_spawnattr_destroy(&attributes);
  if (error != 0) pid = 0;
  return error;
}

}  // namespace

Result<ChildProcess> ChildProcess::start(const std::vector<std::string>& words,
                                         const std::filesystem::path& errors) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, errors.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0644);
  ChildProcess child;
  const int error = spawn(child.pid_, words, actions);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return Error{words[0] + ": " + errno_text(error)};
  return child;
}

Result<ChildProcess> ChildProcess::start_talking(const std::vector<std::string>& words,
                                                 int socket) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, socket, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, socket, STDOUT_FILENO);
  ChildProcess child;
  const int error = spawn(child.pid_, words, actions);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return Error{words[0] + ": " + errno_text(error)};
  return child;
}

bool ChildProcess::is_running() {
  if (pid_ > 0 && ::waitpid(pid_, nullptr, WNOHANG) == pid_) pid_ = 0;
  return pid_ > 0;
}

void ChildProcess::stop() {
  if (!is_running()) return;
  ::kill(pid_, SIGTERM);
  constexpr Duration kPatience = {5'000'000'000};
  const Time limit = monotonic_now() + kPatience;
  while (is_running() && monotonic_now() < limit) {
    sleep_until(monotonic_now() + Duration{20'000'000});
  }
  if (!is_running()) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
  pid_ = 0;
}

}  // namespace zenith::tools
