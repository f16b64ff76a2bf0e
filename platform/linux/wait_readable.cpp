#include "platform/linux/wait_readable.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>

namespace zenith {

int wait_readable(int fd, Duration timeout) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  pollfd entry = {fd, POLLIN, 0};
  const std::int64_t wait_ns = std::max<std::int64_t>(timeout.ns, 0);
  const timespec wait = {static_cast<time_t>(wait_ns / kSecond_ns),
                         static_cast<long>(wait_ns % kSecond_ns)};
  const int ready = ::ppoll(&entry, 1, &wait, nullptr);
  if (ready > 0) return entry.revents;
  return ready == 0 || errno == EINTR ? 0 : -errno;
}

}  // namespace zenith
