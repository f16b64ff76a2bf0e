#include "platform/link/sealing.h"

#include <sodium.h>

#include <algorithm>
#include <array>
#include <cassert>

#include "platform/base/ensure.h"
#include "slam/exchange/bytes.h"

namespace zenith {
namespace {

constexpr std::uint8_t kMagic0 = 0x5A;
constexpr std::uint8_t kMagic1 = 0x4E;
constexpr std::string_view kSenderPurpose = "zenith sender";
constexpr std::string_view kRobotPurpose = "zenith robot";

using Nonce = std::array<std::uint8_t, crypto_aead_chacha20poly1305_ietf_NPUBBYTES>;

static_assert(kTagBytes == crypto_aead_chacha20poly1305_ietf_ABYTES);
static_assert(SecretKey::kBytes == crypto_aead_chacha20poly1305_ietf_KEYBYTES);

// Four zero bytes and the counter, as the header has it.
Nonce nonce_of(const std::uint8_t* header) {
  constexpr std::size_t kCounterAt = 24;
  Nonce nonce = {};
  std::copy_n(header + kCounterAt, 8, nonce.begin() + 4);
  return nonce;
}

void write_header(const FrameHeader& header, std::span<std::uint8_t> out) {
  exchange::ByteWriter writer(out.first(kHeaderBytes));
  writer.u8(kMagic0);
  writer.u8(kMagic1);
  writer.u8(header.version);
  writer.u8(header.version_min);
  writer.u8(header.version_max);
  writer.u8(0);
  writer.bytes(header.key_hint);
  writer.u64(header.sender.robot);
  writer.u64(header.sender.boot);
  writer.u64(header.counter);
  assert(writer.left() == 0);
}

}  // namespace

std::uint64_t robot_id(std::string_view name) {
  std::array<std::uint8_t, 32> hash;
  crypto_generichash(hash.data(), hash.size(), reinterpret_cast<const unsigned char*>(name.data()),
                     name.size(), nullptr, 0);
  return exchange::ByteReader(hash).u64();
}

SenderId masked(const SecretKey& fleet_key, const SenderId& sender) {
  std::array<std::uint8_t, kRobotPurpose.size() + 8> what;
  exchange::ByteWriter writer(what);
  for (const char c : kRobotPurpose) writer.u8(static_cast<std::uint8_t>(c));
  writer.u64(sender.boot);
  assert(writer.left() == 0);
  std::array<std::uint8_t, 32> mask;
  crypto_generichash(mask.data(), mask.size(), what.data(), what.size(), fleet_key.bytes().data(),
                     SecretKey::kBytes);
  return {sender.robot ^ exchange::ByteReader(mask).u64(), sender.boot};
}

SecretKey sender_key(const SecretKey& fleet_key, const SenderId& shown) {
  std::array<std::uint8_t, kSenderPurpose.size() + 16> what;
  exchange::ByteWriter writer(what);
  for (const char c : kSenderPurpose) writer.u8(static_cast<std::uint8_t>(c));
  writer.u64(shown.robot);
  writer.u64(shown.boot);
  assert(writer.left() == 0);
  SecretKey key;
  crypto_generichash(key.bytes().data(), SecretKey::kBytes, what.data(), what.size(),
                     fleet_key.bytes().data(), SecretKey::kBytes);
  return key;
}

bool read_header(std::span<const std::uint8_t> datagram, FrameHeader& out) {
  if (datagram.size() < kHeaderBytes + kTagBytes || datagram.size() > kMaxDatagramBytes ||
      datagram[0] != kMagic0 || datagram[1] != kMagic1) {
    return false;
  }
  exchange::ByteReader reader(datagram.subspan(2, kHeaderBytes - 2));
  out.version = reader.u8();
  out.version_min = reader.u8();
  out.version_max = reader.u8();
  reader.u8();
  out.key_hint = {reader.u8(), reader.u8()};
  out.sender.robot = reader.u64();
  out.sender.boot = reader.u64();
  out.counter = reader.u64();
  return reader.done();
}

std::size_t seal(const SecretKey& sender_key, const FrameHeader& header,
                 std::span<const std::uint8_t> payload, std::span<std::uint8_t> out) {
  ensure(payload.size() <= kMaxPayloadBytes, "seal: a payload has at most kMaxPayloadBytes");
  ensure(out.size() >= kHeaderBytes + payload.size() + kTagBytes, "seal: the datagram has no room");
  write_header(header, out);
  const Nonce nonce = nonce_of(out.data());
  unsigned long long sealed = 0;
  crypto_aead_chacha20poly1305_ietf_encrypt(out.data() + kHeaderBytes, &sealed, payload.data(),
                                            payload.size(), out.data(), kHeaderBytes, nullptr,
                                            nonce.data(), sender_key.bytes().data());
  return kHeaderBytes + static_cast<std::size_t>(sealed);
}

bool open(const SecretKey& sender_key, std::span<const std::uint8_t> datagram,
          std::span<std::uint8_t> payload, std::size_t& payload_bytes) {
  payload_bytes = 0;
  if (datagram.size() < kHeaderBytes + kTagBytes) return false;
  const std::size_t expected = datagram.size() - kHeaderBytes - kTagBytes;
  if (payload.size() < expected) return false;
  const Nonce nonce = nonce_of(datagram.data());
  const std::uint8_t* sealed = datagram.data() + kHeaderBytes;
  if (crypto_aead_chacha20poly1305_ietf_decrypt_detached(
          payload.data(), nullptr, sealed, expected, sealed + expected, datagram.data(),
          kHeaderBytes, nonce.data(), sender_key.bytes().data()) != 0) {
    return false;
  }
  payload_bytes = expected;
  return true;
}

}  // namespace zenith
