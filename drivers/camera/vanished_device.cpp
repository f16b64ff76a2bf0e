#include "drivers/camera/vanished_device.h"

#include <dirent.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>

namespace zenith {
namespace {

constexpr unsigned kVideo4LinuxMajor = 81;  // Linux, Documentation/admin-guide/devices.txt

bool is_video_device(int fd) {
  struct stat file = {};
  return ::fstat(fd, &file) == 0 && S_ISCHR(file.st_mode) &&
         major(file.st_rdev) == kVideo4LinuxMajor;
}

}  // namespace

int query_video_device(int fd) {
  v4l2_capability capability = {};
  return ::ioctl(fd, VIDIOC_QUERYCAP, &capability) == 0 ? 0 : -errno;
}

std::vector<int> open_video_devices() {
  std::vector<int> fds;
  DIR* folder = ::opendir("/proc/self/fd");
  if (folder == nullptr) return fds;
  while (const dirent* entry = ::readdir(folder)) {
    if (entry->d_name[0] == '.') continue;
    const int fd = std::atoi(entry->d_name);
    if (is_video_device(fd)) fds.push_back(fd);
  }
  ::closedir(folder);
  return fds;
}

bool has_vanished(const std::vector<int>& fds, QueryVideoDevice query) {
  return std::any_of(fds.begin(), fds.end(), [&](int fd) { return query(fd) == -ENODEV; });
}

}  // namespace zenith
