#include "platform/linux/unique_fd.h"

#include <cerrno>

namespace zenith {

void UniqueFd::reset(int fd) {
  const int saved = errno;
  if (fd_ >= 0) ::close(fd_);
  fd_ = fd;
  errno = saved;
}

}  // namespace zenith
