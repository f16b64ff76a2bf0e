#pragma once
// Numbers as bytes, little-endian, field by field, within bounds: for whatever crosses a wire.
//
// Neither throws nor allocates. What does not fit, or is not there, makes ok() false for good: the
// caller asks once, at the end.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace zenith {

class ByteWriter {
 public:
  explicit ByteWriter(std::span<std::uint8_t> room) : room_(room) {}

  ByteWriter& u8(std::uint8_t value) { return whole(value, 1); }
  ByteWriter& u16(std::uint16_t value) { return whole(value, 2); }
  ByteWriter& u32(std::uint32_t value) { return whole(value, 4); }
  ByteWriter& u64(std::uint64_t value) { return whole(value, 8); }
  ByteWriter& i64(std::int64_t value) { return whole(static_cast<std::uint64_t>(value), 8); }
  ByteWriter& f64(double value) { return whole(std::bit_cast<std::uint64_t>(value), 8); }
  ByteWriter& bytes(std::span<const std::uint8_t> data) {
    if (std::uint8_t* at = take(data.size()); at != nullptr && !data.empty()) {
      std::memcpy(at, data.data(), data.size());
    }
    return *this;
  }
  // Its length as u32, then its bytes.
  ByteWriter& text(std::string_view text) {
    u32(static_cast<std::uint32_t>(text.size()));
    return bytes({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }

  bool ok() const { return ok_; }
  std::size_t size() const { return size_; }

 private:
  std::uint8_t* take(std::size_t count) {
    ok_ = ok_ && count <= room_.size() - size_;
    if (!ok_) return nullptr;
    size_ += count;
    return room_.data() + size_ - count;
  }
  ByteWriter& whole(std::uint64_t value, std::size_t count) {
    std::uint8_t* at = take(count);
    for (std::size_t i = 0; at != nullptr && i < count; ++i) {
      at[i] = static_cast<std::uint8_t>(value >> (8 * i));
    }
    return *this;
  }

  std::span<std::uint8_t> room_;
  std::size_t size_ = 0;
  bool ok_ = true;
};

class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> data) : data_(data) {}

  std::uint8_t u8() { return static_cast<std::uint8_t>(whole(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(whole(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(whole(4)); }
  std::uint64_t u64() { return whole(8); }
  std::int64_t i64() { return static_cast<std::int64_t>(whole(8)); }
  double f64() { return std::bit_cast<double>(whole(8)); }
  // Views into the data; empty when there is not as much.
  std::span<const std::uint8_t> bytes(std::size_t count) {
    ok_ = ok_ && count <= data_.size();
    if (!ok_) return {};
    const auto taken = data_.first(count);
    data_ = data_.subspan(count);
    return taken;
  }
  std::string_view text() {
    const auto taken = bytes(u32());
    return {reinterpret_cast<const char*>(taken.data()), taken.size()};
  }

  bool ok() const { return ok_; }
  std::size_t left() const { return data_.size(); }
  // Read without a mistake, and nothing is left over.
  bool finished() const { return ok_ && data_.empty(); }

 private:
  std::uint64_t whole(std::size_t count) {
    std::uint64_t value = 0;
    const auto taken = bytes(count);
    for (std::size_t i = 0; i < taken.size(); ++i) value |= std::uint64_t{taken[i]} << (8 * i);
    return value;
  }

  std::span<const std::uint8_t> data_;
  bool ok_ = true;
};

}  // namespace zenith
