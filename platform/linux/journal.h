#pragma once
// journald's native protocol: one entry is one datagram of fields (systemd's
// JOURNAL_NATIVE_PROTOCOL).
//
//   NAME=value\n                                    a value without line ends
//   NAME\n <its size, 64 bits little-endian> value\n   any other

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "platform/linux/unique_fd.h"

namespace zenith {

inline constexpr const char* kJournalSocket = "/run/systemd/journal/socket";

// Fields in a fixed place. No input or output.
class JournalEntry {
 public:
  static constexpr std::size_t kBytes = 2048;

  // `name`: capitals, digits, underscores; neither the first of them a digit nor an underscore. A
  // field without room is left out whole.
  void text(std::string_view name, std::string_view value);
  void number(std::string_view name, double value);

  std::string_view bytes() const { return {bytes_.data(), size_}; }

 private:
  std::array<char, kBytes> bytes_;
  std::size_t size_ = 0;
};

// For threads without deadlines.
class JournalSocket {
 public:
  JournalSocket() = default;
  // The journal need not be there yet, and may go and come back.
  explicit JournalSocket(std::string path);

  bool is_open() const { return fd_.is_open(); }
  // Does not wait. False when the journal did not take it.
  bool send(const JournalEntry& entry) const;

 private:
  std::string path_;
  UniqueFd fd_;
};

}  // namespace zenith
