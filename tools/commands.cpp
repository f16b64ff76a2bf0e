#include "tools/commands.h"

#include <cstdio>

namespace zenith::tools {

int fail(const Error& error) {
  std::fflush(stdout);
  std::fprintf(stderr, "zenith: error: %s\n", error.message.c_str());
  return 1;
}

}  // namespace zenith::tools
