#pragma once
// Hands out what comes through the tap, to one recorder at a time: a local stream socket that only
// the daemon's own user and root may open. Messages: wire.h.
//
// For a thread of its own without deadlines. It only ever waits for the recorder's socket, in small
// slices; a recorder that takes nothing for kPatience is let go.

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/base/time.h"
#include "platform/daemon/tap/tap.h"
#include "platform/daemon/tap/wire.h"
#include "platform/linux/local_socket.h"

namespace zenith::tap {

class TapServer {
 public:
  static constexpr Duration kPatience = {10'000'000'000};

  // `tap` must outlive it. All memory is taken here.
  TapServer(Tap& tap, const Hello& hello);
  ~TapServer() { close(); }
  TapServer(const TapServer&) = delete;
  TapServer& operator=(const TapServer&) = delete;

  Status open(const std::string& path);
  // Removes the socket's file.
  void close();
  const std::string& path() const { return listener_.path(); }

  // The thread's body. A recorder gets its end before it returns, when it takes it soon.
  void run(const std::atomic<bool>& stop);
  // One round: waits at most `wait` for something to do, and does it.
  void turn(Duration wait);

  bool recording() const { return recorder_.is_open(); }

 private:
  enum class Sent { kAll, kBlocked, kGone };

  void wait(Duration longest);
  void accept_one();
  void turn_away(UniqueFd fd);
  bool is_ours(int fd) const;
  void begin(UniqueFd fd);
  void pump();
  bool next_message();
  bool next_can();
  Sent send_rest();
  void ask_end(const char* why);
  void forget(const char* why);

  Tap& tap_;
  const std::vector<std::uint8_t> hello_;
  LocalListener listener_;
  Time next_accept_;

  // The recorder, and what it is being sent: `head_`, then `body_`.
  UniqueFd recorder_;
  Time alive_;  // when it last took something
  bool blocked_ = false;
  bool ending_ = false;
  bool end_written_ = false;
  End end_;
  std::array<std::uint8_t, 4096> head_room_;
  std::span<const std::uint8_t> head_;
  std::span<const std::uint8_t> body_;
  bool holds_frame_ = false;
  TappedFrame frame_;
};

}  // namespace zenith::tap
