#pragma once
// journald's socket in a test: takes entries apart as journald does.

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>

#include "tests/support/patience.h"

namespace zenith {

using JournalFields = std::map<std::string, std::string>;

inline JournalFields read_journal_entry(std::string_view bytes) {
  JournalFields fields;
  while (!bytes.empty()) {
    const std::size_t end = bytes.find('\n');
    if (end == std::string_view::npos) return {{"!", "no end"}};
    const std::string_view line = bytes.substr(0, end);
    bytes.remove_prefix(end + 1);
    const std::size_t equals = line.find('=');
    if (equals != std::string_view::npos) {
      fields[std::string(line.substr(0, equals))] = line.substr(equals + 1);
      continue;
    }
    if (bytes.size() < 8) return {{"!", "no size"}};
    std::uint64_t size = 0;
    for (std::size_t i = 8; i-- > 0;) size = size << 8U | static_cast<unsigned char>(bytes[i]);
    bytes.remove_prefix(8);
    if (bytes.size() < size + 1 || bytes[size] != '\n') return {{"!", "another size"}};
    fields[std::string(line)] = bytes.substr(0, size);
    bytes.remove_prefix(size + 1);
  }
  return fields;
}

class JournalReader {
 public:
  explicit JournalReader(const std::string& path)
      : fd_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address = {};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.data(), path.size());
    (void)::bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address);
    const timeval patience = {static_cast<time_t>(kPatience_s), 0};
    ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  ~JournalReader() { ::close(fd_); }
  JournalReader(const JournalReader&) = delete;
  JournalReader& operator=(const JournalReader&) = delete;

  // The next entry; empty when none comes in time.
  JournalFields next() const {
    std::array<char, 65536> bytes;
    const ssize_t size = ::recv(fd_, bytes.data(), bytes.size(), 0);
    if (size <= 0) return {};
    return read_journal_entry({bytes.data(), static_cast<std::size_t>(size)});
  }

 private:
  int fd_;
};

}  // namespace zenith
