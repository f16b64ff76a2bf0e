#pragma once
// For the child process of a death test: gives up root, if it had it, and the limits that allow
// realtime work, so that the kernel's refusals can be tested anywhere.

#include <sys/resource.h>
#include <unistd.h>

namespace zenith {

inline bool give_up_rights() {
  constexpr uid_t kNobody = 65534;
  const rlimit none = {0, 0};
  if (setrlimit(RLIMIT_RTPRIO, &none) != 0 || setrlimit(RLIMIT_MEMLOCK, &none) != 0) return false;
  return geteuid() != 0 || (setgid(kNobody) == 0 && setuid(kNobody) == 0);
}

}  // namespace zenith
