#pragma once
// A local socket that tells whoever connects: AF_UNIX, SOCK_SEQPACKET, one packet a line. Nobody
// who reads can hold the daemon up, nor the other readers: a line that a reader has no room for is
// dropped for it, and the maps' lines wait for it alone.
//
// A reader may say one thing: "picture" in a packet asks for pictures during the next kLookLasts.
//
// For a thread without deadlines, one thread at a time.

#include <sys/types.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "platform/base/result.h"
#include "platform/base/time.h"
#include "platform/daemon/map_lines.h"
#include "platform/linux/local_socket.h"

namespace zenith {

class TelemetrySocket {
 public:
  static constexpr std::size_t kReaders = 8;  // further ones are turned away
  // Of one user who is neither root nor the daemon's own; the other places stay free for others.
  static constexpr std::size_t kReadersOfOne = 4;
  static constexpr int kAcceptsAtOnce = 4;  // in one call of accept(); the others wait
  static constexpr Duration kLookLasts = {3'000'000'000};

  TelemetrySocket() = default;
  TelemetrySocket(const TelemetrySocket&) = delete;
  TelemetrySocket& operator=(const TelemetrySocket&) = delete;
  ~TelemetrySocket() { close(); }

  // A socket that a daemon left behind is replaced; one that somebody listens on is an error.
  Status open(const std::string& path);
  void close();  // removes the socket's file
  const std::string& path() const { return listener_.path(); }

  // Takes in who wants to connect; each gets `hello` first. Returns how many are new.
  std::size_t accept(std::string_view hello);
  // To all readers; forgets those that left.
  void send(std::string_view line);
  // To each reader the maps' lines that it has yet to get, some of them: to be called again and
  // again. One that is too far behind is let go, and begins anew when it connects again.
  void send_maps(const MapLines& maps, const MapLines::NameOf& name_of);
  // What readers ask. True when any wants pictures.
  bool take_requests(Time now);
  // To those that want pictures.
  void send_to_lookers(std::string_view line, Time now);

  std::size_t readers() const;
  std::uint64_t dropped() const { return dropped_; }  // lines, over all readers

 private:
  struct Reader {
    UniqueFd fd;
    uid_t user = 0;
    Time looks_until;
    MapPlace place;  // in the maps' lines
  };
  Reader* place_for(uid_t user);
  // False when there was no room, or the reader has left.
  bool send_to(Reader& reader, std::string_view line);

  LocalListener listener_;
  std::array<Reader, kReaders> readers_;
  std::uint64_t dropped_ = 0;
};

}  // namespace zenith
