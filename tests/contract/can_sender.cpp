#include "tests/contract/can_sender.h"

#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include <gtest/gtest.h>

#include "platform/linux/errno_text.h"

namespace zenith {

CanSender::CanSender() {
  const char* name = std::getenv("ZENITH_TEST_CAN");
  if (name == nullptr || *name == '\0') {
    missing_ = "no virtual CAN interface: ZENITH_TEST_CAN is not set";
    return;
  }
  interface_ = name;
  open();
}

CanSender::CanSender(std::string interface) : interface_(std::move(interface)) {
  open();
}

void CanSender::open() {
  fd_.reset(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW));
  sockaddr_can address = {};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(::if_nametoindex(interface_.c_str()));
  const bool bound =
      fd_.is_open() && address.can_ifindex != 0 &&
      ::bind(fd_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  if (!bound) missing_ = "cannot send on " + interface_ + ": " + errno_text(errno);
}

void CanSender::send(const can_frame& frame) {
  ASSERT_EQ(::write(fd_.get(), &frame, sizeof frame), static_cast<ssize_t>(sizeof frame))
      << errno_text(errno);
}

void CanSender::set_up(bool up) {
  ifreq request = {};
  std::strncpy(request.ifr_name, interface_.c_str(), sizeof request.ifr_name - 1);
  ASSERT_EQ(::ioctl(fd_.get(), SIOCGIFFLAGS, &request), 0) << errno_text(errno);
  const int flags = up ? request.ifr_flags | IFF_UP : request.ifr_flags & ~IFF_UP;
  request.ifr_flags = static_cast<short>(flags);
  ASSERT_EQ(::ioctl(fd_.get(), SIOCSIFFLAGS, &request), 0) << errno_text(errno);
  // The sender's socket is told as well, and would tell it with the next frame.
  int told = 0;
  socklen_t bytes = sizeof told;
  ::getsockopt(fd_.get(), SOL_SOCKET, SO_ERROR, &told, &bytes);
}

}  // namespace zenith
