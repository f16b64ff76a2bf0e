#include "tools/commands.h"

#include <cstdio>

namespace zenith::tools {
namespace {

void print_lines(const char* kind, const std::string& text) {
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::fprintf(stderr, "zenith: %s: %s\n", kind, text.substr(begin, end - begin).c_str());
    begin = end + 1;
  }
}

}  // namespace

void add_set_option(CLI::App& command, std::vector<std::string>& assignments) {
  // One value an option, so that `--set a=1 WORLD` leaves WORLD alone.
  command
      .add_option("--set", assignments,
                  "key=value: change a parameter of `zenith --parameters`; repeatable")
      ->type_size(1)
      ->allow_extra_args(false)
      ->take_all();
}

int fail(const Error& error) {
  std::fflush(stdout);
  print_lines("error", error.message);
  return 1;
}

void warn(const std::vector<std::string>& warnings) {
  std::fflush(stdout);
  for (const std::string& warning : warnings) print_lines("warning", warning);
}

}  // namespace zenith::tools
