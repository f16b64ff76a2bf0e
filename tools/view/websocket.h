#pragma once
// WebSocket (RFC 6455) as a server speaks it, without a socket: frames in, messages out. What a
// client may send is bounded before it is kept.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace zenith::tools {

enum class WebOpcode : std::uint8_t {
  kContinuation = 0,
  kText = 1,
  kBinary = 2,
  kClose = 8,
  kPing = 9,
  kPong = 10
};

inline constexpr std::uint16_t kCloseNormal = 1000;
inline constexpr std::uint16_t kCloseGoingAway = 1001;
inline constexpr std::uint16_t kCloseProtocol = 1002;
inline constexpr std::uint16_t kCloseRefused = 1008;
inline constexpr std::uint16_t kCloseTooLong = 1009;

// Sec-WebSocket-Accept for a Sec-WebSocket-Key.
std::string websocket_accept(std::string_view key);
// Whether it is sixteen bytes in base64.
bool is_websocket_key(std::string_view key);

std::string websocket_frame(WebOpcode opcode, std::string_view payload);
std::string websocket_close(std::uint16_t code);

// Puts a client's frames together.
class WebSocketReader {
 public:
  // Of a message with all its fragments.
  static constexpr std::size_t kMostBytes = std::size_t{64} << 10U;

  enum class Kind { kNothing, kMessage, kPing, kPong, kClose, kFault };
  struct Event {
    Kind kind = Kind::kNothing;
    bool binary = false;
    std::string payload;
    std::uint16_t close_code = 0;  // of kFault: what to close with
  };

  void feed(std::string_view bytes) { waiting_ += bytes; }
  // What is whole; kNothing: more bytes are needed. After a fault nothing more comes.
  Event next();
  // Bytes that are kept.
  std::size_t kept() const { return waiting_.size() + message_.size(); }

 private:
  struct Frame {
    WebOpcode opcode = WebOpcode::kText;
    bool last = false;
    std::size_t header = 0;
    std::size_t size = 0;
  };
  Event fault(std::uint16_t code);
  // The close code of what is wrong, 0: nothing, and whether the header is whole.
  std::uint16_t read_header(Frame& frame, bool& whole) const;
  std::uint16_t check(const Frame& frame) const;
  Event take(const Frame& frame);

  std::string waiting_;
  std::string message_;  // fragments
  bool in_message_ = false;
  bool binary_ = false;
  bool failed_ = false;
};

}  // namespace zenith::tools
