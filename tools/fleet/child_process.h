#pragma once
// A program that runs beside this one and ends with it.

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "platform/base/result.h"

namespace zenith::tools {

class ChildProcess {
 public:
  ChildProcess() = default;
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  ~ChildProcess();

  // Its standard error goes to the file.
  static Result<ChildProcess> start(const std::vector<std::string>& words,
                                    const std::filesystem::path& errors);

  // A program that is looked for in PATH, whose standard input and output are `socket`; its
  // standard error is this program's.
  static Result<ChildProcess> start_talking(const std::vector<std::string>& words, int socket);

  bool is_running();
  // Asks it to end, and waits some seconds; then it is ended.
  void stop();

 private:
  pid_t pid_ = 0;
};

}  // namespace zenith::tools
