#include "platform/linux/journal.h"

#include <sys/socket.h>
#include <sys/un.h>

#include <cassert>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <utility>

namespace zenith {

void JournalEntry::text(std::string_view name, std::string_view value) {
  assert(!name.empty() && name[0] >= 'A' && name[0] <= 'Z');
  const bool plain = value.find('\n') == std::string_view::npos;
  const std::size_t between = plain ? 1 : 1 + sizeof(std::uint64_t);
  if (name.size() + between + value.size() + 1 > kBytes - size_) return;
  const auto put = [this](std::string_view piece) {
    size_ += piece.copy(bytes_.data() + size_, piece.size());
  };
  put(name);
  if (plain) {
    put("=");
  } else {
    std::array<char, sizeof(std::uint64_t)> length;
    for (std::size_t i = 0; i < length.size(); ++i) {
      length[i] = static_cast<char>(value.size() >> (8 * i) & 0xffU);
    }
    put("\n");
    put({length.data(), length.size()});
  }
  put(value);
  put("\n");
}

void JournalEntry::number(std::string_view name, double value) {
  std::array<char, 32> digits;
  const int size = std::snprintf(digits.data(), digits.size(), "%.9g", value);
  text(name, {digits.data(), static_cast<std::size_t>(size)});
}

JournalSocket::JournalSocket(std::string path)
    : path_(std::move(path)), fd_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}

bool JournalSocket::send(const JournalEntry& entry) const {
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  if (!fd_.is_open() || path_.size() >= sizeof(address.sun_path)) return false;
  std::memcpy(address.sun_path, path_.data(), path_.size());
  const std::string_view bytes = entry.bytes();
  ssize_t sent = 0;
  do {
    sent = ::sendto(fd_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                    reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  } while (sent < 0 && errno == EINTR);
  return sent == static_cast<ssize_t>(bytes.size());
}

}  // namespace zenith
