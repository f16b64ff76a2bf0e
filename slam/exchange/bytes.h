#pragma once
// Little-endian integers in bounded bytes. Reading or writing beyond the end does nothing but set
// failed(), which is asked once at the end; read values are then 0.

#include <cstddef>
#include <cstdint>
#include <span>

namespace zenith::exchange {

using Bytes = std::span<const std::uint8_t>;

class ByteReader {
 public:
  explicit ByteReader(Bytes bytes) : bytes_(bytes) {}

  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t u64() { return number(8); }
  std::int8_t i8() { return static_cast<std::int8_t>(u8()); }
  std::int32_t i24() {
    const auto value = static_cast<std::int32_t>(number(3));
    return value < 0x800000 ? value : value - 0x1000000;
  }
  std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
  Bytes take(std::size_t count) {
    if (count > left()) {
      failed_ = true;
      return {};
    }
    const Bytes taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }

  std::size_t left() const { return bytes_.size(); }
  bool failed() const { return failed_; }
  // All was read and nothing more than there was.
  bool done() const { return !failed_ && bytes_.empty(); }

 private:
  std::uint64_t number(std::size_t count) {
    std::uint64_t value = 0;
    const Bytes taken = take(count);
    for (std::size_t i = taken.size(); i > 0; --i) value = value << 8u | taken[i - 1];
    return value;
  }

  Bytes bytes_;
  bool failed_ = false;
};

class ByteWriter {
 public:
  explicit ByteWriter(std::span<std::uint8_t> room) : room_(room) {}

  void u8(std::uint8_t value) { number(value, 1); }
  void u16(std::uint16_t value) { number(value, 2); }
  void u32(std::uint32_t value) { number(value, 4); }
  void u64(std::uint64_t value) { number(value, 8); }
  void i8(std::int8_t value) { u8(static_cast<std::uint8_t>(value)); }
  void i24(std::int32_t value) { number(static_cast<std::uint32_t>(value), 3); }
  void i32(std::int32_t value) { u32(static_cast<std::uint32_t>(value)); }
  void bytes(Bytes source) {
    if (source.size() > left()) {
      failed_ = true;
      return;
    }
    for (const std::uint8_t byte : source) room_[size_++] = byte;
  }
  // Over what was written before.
  void overwrite_u8(std::size_t at, std::uint8_t value) {
    if (at < size_) room_[at] = value;
  }
  void overwrite_u16(std::size_t at, std::uint16_t value) {
    overwrite_u8(at, static_cast<std::uint8_t>(value));
    overwrite_u8(at + 1, static_cast<std::uint8_t>(value >> 8u));
  }
  void overwrite_u32(std::size_t at, std::uint32_t value) {
    overwrite_u16(at, static_cast<std::uint16_t>(value));
    overwrite_u16(at + 2, static_cast<std::uint16_t>(value >> 16u));
  }

  std::size_t size() const { return size_; }
  std::size_t left() const { return room_.size() - size_; }
  bool failed() const { return failed_; }
  Bytes written() const { return room_.first(size_); }
  // Takes back all that was written behind `size`, and the failure.
  void shrink_to(std::size_t size) {
    if (size < size_) size_ = size;
    failed_ = false;
  }

 private:
  void number(std::uint64_t value, std::size_t count) {
    if (count > left()) {
      failed_ = true;
      return;
    }
    for (std::size_t i = 0; i < count; ++i, value >>= 8u) {
      room_[size_++] = static_cast<std::uint8_t>(value);
    }
  }

  std::span<std::uint8_t> room_;
  std::size_t size_ = 0;
  bool failed_ = false;
};

}  // namespace zenith::exchange
