#pragma once
// CRC-32 (IEEE 802.3, reflected), as zip and Ethernet have it: finds all bursts up to 32 bits.

#include <array>
#include <cstdint>

#include "platform/base/bytes.h"

namespace zenith::storage {

inline constexpr std::array<std::uint32_t, 256> kCrcTable = [] {
  std::array<std::uint32_t, 256> table = {};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    std::uint32_t crc = i;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1u) ^ ((crc & 1u) * 0xEDB88320u);
    table[i] = crc;
  }
  return table;
}();

inline std::uint32_t crc32(Bytes bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const std::uint8_t byte : bytes) crc = (crc >> 8u) ^ kCrcTable[(crc ^ byte) & 0xFFu];
  return ~crc;
}

}  // namespace zenith::storage
