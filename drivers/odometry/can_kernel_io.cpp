#include <dirent.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "drivers/odometry/can_io.h"
#include "platform/linux/clock.h"
#include "platform/linux/input_file.h"
#include "platform/linux/wait_readable.h"

namespace zenith {
namespace {

constexpr const char* kInterfaces = "/sys/class/net";
constexpr std::int64_t kSecond_ns = 1'000'000'000;
// The clocks are read again when the thread was interrupted between them for longer than this.
constexpr Duration kMaxReading = {20'000};
constexpr int kReadings = 4;

std::int64_t ns_of(const timespec& time) {
  return std::int64_t{time.tv_sec} * kSecond_ns + time.tv_nsec;
}

bool is_can(const char* interface) {
  const std::string path = std::string(kInterfaces) + "/" + interface + "/type";
  constexpr std::uint64_t kLargestPage = 65536;  // what /sys says of each of its files' sizes
  const auto text = read_input(path, kLargestPage);
  return text && std::atoi(text->c_str()) == ARPHRD_CAN;
}

template <typename T>
std::optional<T> payload(const cmsghdr& header) {
  if (header.cmsg_len < CMSG_LEN(sizeof(T))) return std::nullopt;
  T value;
  std::memcpy(&value, CMSG_DATA(&header), sizeof value);
  return value;
}

void read_control(msghdr& message, CanDatagram& out) {
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr;
       part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET) continue;
    if (part->cmsg_type == SCM_TIMESTAMPNS) {
      if (const auto stamp = payload<timespec>(*part)) out.stamp_ns = ns_of(*stamp);
    } else if (part->cmsg_type == SO_RXQ_OVFL) {
      out.drops_sum = payload<std::uint32_t>(*part);
    }
  }
}

class KernelCanIo final : public CanIo {
 public:
  std::vector<std::string> list() override {
    std::vector<std::string> names;
    if (DIR* folder = ::opendir(kInterfaces)) {
      while (const dirent* entry = ::readdir(folder)) {
        if (entry->d_name[0] != '.' && is_can(entry->d_name)) names.emplace_back(entry->d_name);
      }
      ::closedir(folder);
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  int index_of(const char* interface) override {
    const unsigned index = ::if_nametoindex(interface);
    return index != 0 ? static_cast<int>(index) : -errno;
  }

  int is_up(int fd, const char* interface) override {
    ifreq request = {};
    std::strncpy(request.ifr_name, interface, sizeof request.ifr_name - 1);
    if (::ioctl(fd, SIOCGIFFLAGS, &request) < 0) return -errno;
    return (request.ifr_flags & IFF_UP) != 0 ? 1 : 0;
  }

  int open() override {
    const int fd = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    return fd >= 0 ? fd : -errno;
  }

  void close(int fd) override { ::close(fd); }

  int set_option(int fd, int level, int option, const void* value, std::size_t bytes) override {
    const int result = ::setsockopt(fd, level, option, value, static_cast<socklen_t>(bytes));
    return result >= 0 ? result : -errno;
  }

  int bind(int fd, int index) override {
    sockaddr_can address = {};
    address.can_family = AF_CAN;
    address.can_ifindex = index;
    const int result = ::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address);
    return result >= 0 ? result : -errno;
  }

  int receive(int fd, CanDatagram& out) override {
    iovec data = {&out.frame, sizeof out.frame};
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t))];
    msghdr message = {};
    message.msg_iov = &data;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    ssize_t bytes = 0;
    do {
      bytes = ::recvmsg(fd, &message, MSG_DONTWAIT);
    } while (bytes < 0 && errno == EINTR);
    if (bytes < 0) return -errno;
    out.bytes = static_cast<std::size_t>(bytes);
    out.stamp_ns.reset();
    out.drops_sum.reset();
    read_control(message, out);
    return 0;
  }

  int poll(int fd, Duration timeout) override { return wait_readable(fd, timeout); }

  Time now() override { return monotonic_now(); }

  CanClocks clocks() override {
    CanClocks clocks;
    for (int i = 0; i < kReadings; ++i) {
      const Time before = monotonic_now();
      timespec real = {};
      clock_gettime(CLOCK_REALTIME, &real);
      const Time after = monotonic_now();
      clocks = {Time{before.ns + (after - before).ns / 2}, ns_of(real)};
      if (after - before <= kMaxReading) break;
    }
    return clocks;
  }
};

}  // namespace

CanIo& kernel_can_io() {
  static KernelCanIo io;
  return io;
}

}  // namespace zenith
