#pragma once
// The frame around every payload: docs/protocol.md, "Datagrams". ChaCha20-Poly1305 (RFC 8439) with
// a key for each boot of each robot, derived from the fleet's key. Pure; no heap.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "platform/link/fleet_key.h"

namespace zenith {

inline constexpr std::size_t kHeaderBytes = 32;
inline constexpr std::size_t kTagBytes = 16;
inline constexpr std::size_t kMaxDatagramBytes = 1200;
inline constexpr std::size_t kMaxPayloadBytes = kMaxDatagramBytes - kHeaderBytes - kTagBytes;

inline constexpr std::uint8_t kProtocolVersion = 2;

// One run of the program on one robot.
struct SenderId {
  std::uint64_t robot = 0;  // robot_id() of its name
  std::uint64_t boot = 0;   // random

  bool operator==(const SenderId&) const = default;
};

struct FrameHeader {
  std::uint8_t version = kProtocolVersion;  // of the payload
  std::uint8_t version_min = kProtocolVersion;
  std::uint8_t version_max = kProtocolVersion;
  KeyHint key_hint = {};
  SenderId sender;  // masked()
  std::uint64_t counter = 0;
};

std::uint64_t robot_id(std::string_view name);

// The sender as the header shows it to everybody: its robot is combined with a number that takes
// the fleet's key to compute and differs from boot to boot. Without the key neither the robot can
// be told from it nor that two boots are of one robot. Masked twice it is the plain one again.
SenderId masked(const SecretKey& fleet_key, const SenderId& sender);

// The key of what a sender seals; `shown` is as the header has it.
SecretKey sender_key(const SecretKey& fleet_key, const SenderId& shown);

// False when it is no datagram of ours: too short, too long, another magic. What it says is not
// believed before open().
bool read_header(std::span<const std::uint8_t> datagram, FrameHeader& out);

// Header, encrypted payload and tag into `out`; returns the bytes. A payload longer than
// kMaxPayloadBytes, or an `out` without room for it, is a programmer's mistake.
std::size_t seal(const SecretKey& sender_key, const FrameHeader& header,
                 std::span<const std::uint8_t> payload, std::span<std::uint8_t> out);

// False when the tag is wrong: `payload` is then not to be used. A `payload` of kMaxPayloadBytes
// has room for all. The datagram is one that read_header() took.
bool open(const SecretKey& sender_key, std::span<const std::uint8_t> datagram,
          std::span<std::uint8_t> payload, std::size_t& payload_bytes);

}  // namespace zenith
