#pragma once
// Bytes as text: RFC 4648's base64 with padding.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace zenith {

inline constexpr std::string_view kBase64Digits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

constexpr std::size_t base64_size(std::size_t bytes) {
  return (bytes + 2) / 3 * 4;
}

// Writes base64_size(bytes.size()) characters to `out`.
inline void write_base64(std::span<const std::uint8_t> bytes, char* out) {
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const std::uint32_t group = std::uint32_t{bytes[i]} << 16U |
                                (left > 1 ? std::uint32_t{bytes[i + 1]} << 8U : 0U) |
                                (left > 2 ? std::uint32_t{bytes[i + 2]} : 0U);
    *out++ = kBase64Digits[group >> 18U];
    *out++ = kBase64Digits[group >> 12U & 63U];
    *out++ = left > 1 ? kBase64Digits[group >> 6U & 63U] : '=';
    *out++ = left > 2 ? kBase64Digits[group & 63U] : '=';
  }
}

// Nothing when the text is no base64.
inline std::optional<std::vector<std::uint8_t>> read_base64(std::string_view text) {
  if (text.size() % 4 != 0) return std::nullopt;
  std::vector<std::uint8_t> bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t group = 0;
  std::size_t padding = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool pads = text[i] == '=' && i + 2 >= text.size();
    const std::size_t digit = pads ? 0 : kBase64Digits.find(text[i]);
    if (digit == std::string_view::npos || (!pads && padding > 0)) return std::nullopt;
    padding += pads ? 1 : 0;
    group = group << 6U | static_cast<std::uint32_t>(digit);
    if (i % 4 != 3) continue;
    for (const unsigned shift : {16U, 8U, 0U}) {
      bytes.push_back(static_cast<std::uint8_t>(group >> shift));
    }
  }
  bytes.resize(bytes.size() - padding);
  return bytes;
}

}  // namespace zenith
