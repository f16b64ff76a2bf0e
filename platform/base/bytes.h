#pragma once
// Little-endian numbers in bounded bytes, field by field, for what crosses a wire. Reading or
// writing beyond the end does nothing but set failed(), which is asked once at the end; read values
// are then 0. Neither throws nor allocates.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace zenith {

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
  std::int64_t i64() { return static_cast<std::int64_t>(u64()); }
  double f64() { return std::bit_cast<double>(u64()); }
  // A u32 length and as many bytes.
  std::string_view text() {
    const Bytes taken = take(u32());
    return {reinterpret_cast<const char*>(taken.data()), taken.size()};
  }
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

  ByteWriter& u8(std::uint8_t value) { return number(value, 1); }
  ByteWriter& u16(std::uint16_t value) { return number(value, 2); }
  ByteWriter& u32(std::uint32_t value) { return number(value, 4); }
  ByteWriter& u64(std::uint64_t value) { return number(value, 8); }
  ByteWriter& i8(std::int8_t value) { return u8(static_cast<std::uint8_t>(value)); }
  ByteWriter& i24(std::int32_t value) { return number(static_cast<std::uint32_t>(value), 3); }
  ByteWriter& i32(std::int32_t value) { return u32(static_cast<std::uint32_t>(value)); }
  ByteWriter& i64(std::int64_t value) { return u64(static_cast<std::uint64_t>(value)); }
  ByteWriter& f64(double value) { return u64(std::bit_cast<std::uint64_t>(value)); }
  ByteWriter& bytes(Bytes source) {
    if (source.size() > left()) {
      failed_ = true;
      return *this;
    }
    for (const std::uint8_t byte : source) room_[size_++] = byte;
    return *this;
  }
  // A u32 length and the text's bytes.
  ByteWriter& text(std::string_view text) {
    u32(static_cast<std::uint32_t>(text.size()));
    return bytes({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
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
  ByteWriter& number(std::uint64_t value, std::size_t count) {
    if (count > left()) {
      failed_ = true;
      return *this;
    }
    for (std::size_t i = 0; i < count; ++i, value >>= 8u) {
      room_[size_++] = static_cast<std::uint8_t>(value);
    }
    return *this;
  }

  std::span<std::uint8_t> room_;
  std::size_t size_ = 0;
  bool failed_ = false;
};

}  // namespace zenith
