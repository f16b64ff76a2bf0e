#pragma once
// A local socket that tells whoever connects: AF_UNIX, SOCK_SEQPACKET, one packet a line. Nobody
// who reads can hold the daemon up: a line that a reader has no room for is dropped for it.
//
// For a thread without deadlines, one thread at a time.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "platform/base/result.h"
#include "platform/linux/unique_fd.h"

namespace zenith {

class TelemetrySocket {
 public:
  static constexpr std::size_t kReaders = 8;  // further ones are turned away

  TelemetrySocket() = default;
  TelemetrySocket(const TelemetrySocket&) = delete;
  TelemetrySocket& operator=(const TelemetrySocket&) = delete;
  ~TelemetrySocket() { close(); }

  // A socket that a daemon left behind is replaced; one that somebody listens on is an error.
  Status open(const std::string& path);
  void close();  // removes the socket's file
  const std::string& path() const { return path_; }

  // Takes in who wants to connect; each gets `hello` first. Returns how many are new.
  std::size_t accept(std::string_view hello);
  // To all readers; forgets those that left.
  void send(std::string_view line);

  std::size_t readers() const;
  std::uint64_t dropped() const { return dropped_; }  // lines, over all readers

 private:
  void send_to(UniqueFd& reader, std::string_view line);

  std::string path_;
  UniqueFd listener_;
  std::array<UniqueFd, kReaders> readers_;
  std::uint64_t dropped_ = 0;
};

}  // namespace zenith
