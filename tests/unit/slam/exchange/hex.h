#pragma once
// Golden bytes as text: "5A 4e 01" and back. Blanks are free.

#include <cctype>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "slam/exchange/bytes.h"

namespace zenith::exchange {

inline std::vector<std::uint8_t> from_hex(std::string_view text) {
  std::vector<std::uint8_t> bytes;
  std::string pair;
  for (const char c : text) {
    if (std::isxdigit(static_cast<unsigned char>(c)) == 0) continue;
    pair += c;
    if (pair.size() < 2) continue;
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(pair, nullptr, 16)));
    pair.clear();
  }
  return bytes;
}

inline std::string to_hex(Bytes bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += "0123456789abcdef"[byte >> 4u];
    text += "0123456789abcdef"[byte & 0xFu];
    text += ' ';
  }
  return text;
}

}  // namespace zenith::exchange
