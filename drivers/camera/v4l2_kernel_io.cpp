#include <dirent.h>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "drivers/camera/v4l2_io.h"
#include "platform/linux/clock.h"
#include "platform/linux/wait_readable.h"

namespace zenith {
namespace {

constexpr const char* kFolder = "/dev";
constexpr const char* kPrefix = "video";

// 12 for "video12"; -1 for anything else.
long video_number(const char* name) {
  const std::size_t prefix = std::strlen(kPrefix);
  if (std::strncmp(name, kPrefix, prefix) != 0 || name[prefix] == '\0') return -1;
  char* end = nullptr;
  const long number = std::strtol(name + prefix, &end, 10);
  return *end == '\0' && number >= 0 ? number : -1;
}

class KernelV4l2Io final : public V4l2Io {
 public:
  std::vector<std::string> list() override {
    std::vector<long> numbers;
    if (DIR* folder = ::opendir(kFolder)) {
      while (const dirent* entry = ::readdir(folder)) {
        const long number = video_number(entry->d_name);
        if (number >= 0) numbers.push_back(number);
      }
      ::closedir(folder);
    }
    std::sort(numbers.begin(), numbers.end());
    std::vector<std::string> paths;
    for (const long number : numbers) {
      paths.push_back(std::string(kFolder) + "/" + kPrefix + std::to_string(number));
    }
    return paths;
  }

  int open(const char* path) override {
    const int fd = ::open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    return fd >= 0 ? fd : -errno;
  }

  void close(int fd) override { ::close(fd); }

  int control(int fd, unsigned long request, void* argument) override {
    int result = 0;
    do {
      result = ::ioctl(fd, request, argument);
    } while (result < 0 && errno == EINTR);
    return result >= 0 ? result : -errno;
  }

  void* map(int fd, std::size_t length, std::int64_t offset) override {
    void* start = ::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, fd, offset);
    return start != MAP_FAILED ? start : nullptr;
  }

  void unmap(void* start, std::size_t length) override { ::munmap(start, length); }

  int poll(int fd, Duration timeout) override { return wait_readable(fd, timeout); }

  Time now() override { return monotonic_now(); }
};

}  // namespace

V4l2Io& kernel_v4l2_io() {
  static KernelV4l2Io io;
  return io;
}

}  // namespace zenith
