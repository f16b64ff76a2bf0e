#include "tools/view/websocket.h"

#include <array>
#include <bit>
#include <utility>

#include "platform/base/base64.h"

namespace zenith::tools {
namespace {

constexpr std::size_t kMostControl = 125;
constexpr std::size_t kMask = 4;

// One block of SHA-1 (FIPS 180-4): WebSocket's handshake asks for it, not for its strength.
void sha1_block(std::array<std::uint32_t, 5>& state, const unsigned char* block) {
  std::array<std::uint32_t, 80> w;
  for (std::size_t i = 0; i < 16; ++i) {
    w[i] = std::uint32_t{block[4 * i]} << 24U | std::uint32_t{block[4 * i + 1]} << 16U |
           std::uint32_t{block[4 * i + 2]} << 8U | std::uint32_t{block[4 * i + 3]};
  }
  for (std::size_t i = 16; i < 80; ++i) {
    w[i] = std::rotl(w[i - 3] ^ w[i - 8] ^ w[i - 14] ^ w[i - 16], 1);
  }
  auto [a, b, c, d, e] = state;
  for (std::size_t i = 0; i < 80; ++i) {
    const std::uint32_t f = i < 20   ? ((b & c) | (~b & d))
                            : i < 40 ? (b ^ c ^ d)
                            : i < 60 ? ((b & c) | (b & d) | (c & d))
                                     : (b ^ c ^ d);
    constexpr std::array<std::uint32_t, 4> kRound = {0x5a827999U, 0x6ed9eba1U, 0x8f1bbcdcU,
                                                     0xca62c1d6U};
    const std::uint32_t next = std::rotl(a, 5) + f + e + kRound[i / 20] + w[i];
    e = d;
    d = c;
    c = std::rotl(b, 30);
    b = a;
    a = next;
  }
  state[0] += a;
  state[1] += b;
  state[2] += c;
  state[3] += d;
  state[4] += e;
}

std::array<std::uint8_t, 20> sha1(std::string text) {
  const std::uint64_t bits = std::uint64_t{text.size()} * 8;
  text += '\x80';
  while (text.size() % 64 != 56) text += '\0';
  for (unsigned shift = 64; shift > 0; shift -= 8) text += static_cast<char>(bits >> (shift - 8));
  std::array<std::uint32_t, 5> state = {0x67452301U, 0xefcdab89U, 0x98badcfeU, 0x10325476U,
                                        0xc3d2e1f0U};
  for (std::size_t i = 0; i < text.size(); i += 64) {
    sha1_block(state, reinterpret_cast<const unsigned char*>(text.data()) + i);
  }
  std::array<std::uint8_t, 20> out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = static_cast<std::uint8_t>(state[i / 4] >> (24 - 8 * (i % 4)));
  }
  return out;
}

bool is_control(WebOpcode opcode) {
  return static_cast<std::uint8_t>(opcode) >= 8;
}

}  // namespace

std::string websocket_accept(std::string_view key) {
  const auto digest = sha1(std::string(key) + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11");
  std::string text(base64_size(digest.size()), ' ');
  write_base64(digest, text.data());
  return text;
}

bool is_websocket_key(std::string_view key) {
  const auto bytes = read_base64(key);
  return bytes && bytes->size() == 16;
}

std::string websocket_frame(WebOpcode opcode, std::string_view payload) {
  std::string frame(1, static_cast<char>(0x80U | static_cast<unsigned>(opcode)));
  const std::size_t size = payload.size();
  const unsigned bytes = size <= kMostControl ? 0U : size <= 0xffff ? 2U : 8U;
  frame += static_cast<char>(bytes == 0 ? size : bytes == 2 ? 126U : 127U);
  for (unsigned shift = 8 * bytes; shift > 0; shift -= 8) {
    frame += static_cast<char>(size >> (shift - 8) & 0xffU);
  }
  return frame.append(payload);
}

std::string websocket_close(std::uint16_t code) {
  const std::array<char, 2> bytes = {static_cast<char>(code >> 8U),
                                     static_cast<char>(code & 0xffU)};
  return websocket_frame(WebOpcode::kClose, {bytes.data(), bytes.size()});
}

WebSocketReader::Event WebSocketReader::fault(std::uint16_t code) {
  failed_ = true;
  waiting_.clear();
  message_.clear();
  return {Kind::kFault, false, "", code};
}

WebSocketReader::Event WebSocketReader::next() {
  if (failed_) {
    waiting_.clear();
    return {};
  }
  while (true) {
    Frame frame;
    bool whole = false;
    if (const std::uint16_t code = read_header(frame, whole); code != 0) return fault(code);
    if (!whole || waiting_.size() < frame.header + frame.size) return {};
    Event event = take(frame);
    if (event.kind != Kind::kNothing) return event;
  }
}

std::uint16_t WebSocketReader::read_header(Frame& frame, bool& whole) const {
  if (waiting_.size() < 2) return 0;
  const auto byte = [this](std::size_t i) { return static_cast<unsigned char>(waiting_[i]); };
  if ((byte(0) & 0x70U) != 0 || (byte(1) & 0x80U) == 0) return kCloseProtocol;
  frame.last = (byte(0) & 0x80U) != 0;
  frame.opcode = static_cast<WebOpcode>(byte(0) & 0x0fU);
  frame.size = byte(1) & 0x7fU;
  const std::size_t more = frame.size == 126 ? 2 : frame.size == 127 ? 8 : 0;
  if (is_control(frame.opcode) && (more > 0 || !frame.last)) return kCloseProtocol;
  if (waiting_.size() < 2 + more) return 0;
  std::uint64_t size = more == 0 ? frame.size : 0;
  for (std::size_t i = 0; i < more; ++i) size = size << 8U | byte(2 + i);
  frame.header = 2 + more + kMask;
  // Before any of it is kept.
  const std::size_t before = is_control(frame.opcode) ? 0 : message_.size();
  if (size > kMostBytes - before) return kCloseTooLong;
  frame.size = static_cast<std::size_t>(size);
  whole = true;
  return check(frame);
}

std::uint16_t WebSocketReader::check(const Frame& frame) const {
  switch (frame.opcode) {
    case WebOpcode::kText:
    case WebOpcode::kBinary:
      return in_message_ ? kCloseProtocol : 0;
    case WebOpcode::kContinuation:
      return in_message_ ? 0 : kCloseProtocol;
    case WebOpcode::kClose:
    case WebOpcode::kPing:
    case WebOpcode::kPong:
      return 0;
  }
  return kCloseProtocol;
}

WebSocketReader::Event WebSocketReader::take(const Frame& frame) {
  std::string payload = waiting_.substr(frame.header, frame.size);
  for (std::size_t i = 0; i < payload.size(); ++i) {
    payload[i] = static_cast<char>(payload[i] ^ waiting_[frame.header - kMask + i % kMask]);
  }
  waiting_.erase(0, frame.header + frame.size);
  if (frame.opcode == WebOpcode::kPing) return {Kind::kPing, false, std::move(payload), 0};
  if (frame.opcode == WebOpcode::kPong) return {Kind::kPong, false, "", 0};
  if (frame.opcode == WebOpcode::kClose) return {Kind::kClose, false, "", 0};
  if (frame.opcode != WebOpcode::kContinuation) binary_ = frame.opcode == WebOpcode::kBinary;
  message_ += payload;
  in_message_ = !frame.last;
  if (in_message_) return {};
  return {Kind::kMessage, binary_, std::exchange(message_, {}), 0};
}

}  // namespace zenith::tools
