#pragma once
// Files and folders as an attacker would leave them, and how much memory it takes to read them.

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "platform/storage/checksum.h"

namespace zenith {

// Three things of the same name on which a reader without care waits for ever or fills the memory.
struct Trap {
  const char* kind;
  void (*lay)(const std::filesystem::path& path);
  const char* told;  // part of the message that is expected
};

inline const std::vector<Trap>& traps() {
  static const std::vector<Trap> all = {
      {"pipe",
       [](const std::filesystem::path& path) { ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0); },
       "found a pipe"},
      {"device",
       [](const std::filesystem::path& path) {
         std::filesystem::create_symlink("/dev/zero", path);
       },
       "found a device"},
      {"sparse file of 100 GB",
       [](const std::filesystem::path& path) {
         std::ofstream(path).close();
         ASSERT_EQ(::truncate(path.c_str(), off_t{100} << 30U), 0);
       },
       "expected at most"}};
  return all;
}

// By how much the process's memory grew at its largest while `work` ran; nothing where the kernel
// does not say.
template <typename Work>
std::optional<std::uint64_t> peak_growth_bytes(const Work& work) {
  const auto status_kb = [](const char* name) -> std::optional<std::uint64_t> {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
      unsigned long long kb = 0;
      if (line.rfind(name, 0) != 0) continue;
      if (std::sscanf(line.c_str() + line.find(':') + 1, "%llu", &kb) == 1) return kb;
    }
    return std::nullopt;
  };
  std::ofstream reset("/proc/self/clear_refs");
  reset << "5" << std::flush;
  const auto before = status_kb("VmRSS:");
  work();
  const auto peak = status_kb("VmHWM:");
  if (!reset || !before || !peak) return std::nullopt;
  return (*peak - std::min(*peak, *before)) * 1024;
}

// PNG files from their parts.
class PngBytes {
 public:
  PngBytes(std::uint32_t width, std::uint32_t height, int depth = 8, int colours = 0,
           int interlace = 0) {
    std::string header = number(width) + number(height);
    for (const int byte : {depth, colours, 0, 0, interlace}) header += static_cast<char>(byte);
    chunk("IHDR", header);
  }
  PngBytes& chunk(const std::string& type, const std::string& content) {
    const std::string checked = type + content;
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(checked.data());
    text_ += number(static_cast<std::uint32_t>(content.size())) + checked +
             number(storage::crc32({bytes, checked.size()}));
    return *this;
  }
  // The rows with their filter bytes, not compressed, in one chunk.
  PngBytes& pixels(const std::string& rows) { return chunk("IDAT", zlib_stored(rows)); }
  std::string end() { return chunk("IEND", "").text_; }

  static std::string number(std::uint32_t value) {
    std::string bytes;
    for (const unsigned shift : {24U, 16U, 8U, 0U}) bytes += static_cast<char>(value >> shift);
    return bytes;
  }
  static std::string zlib_stored(const std::string& content) {
    constexpr std::size_t kBlock = 65535;
    std::string out = "\x78\x01";
    for (std::size_t at = 0; at == 0 || at < content.size(); at += kBlock) {
      const std::string block = content.substr(at, kBlock);
      const auto size = static_cast<std::uint32_t>(block.size());
      out += static_cast<char>(at + kBlock >= content.size() ? 1 : 0);
      for (const std::uint32_t n : {size, ~size}) {
        out += static_cast<char>(n);
        out += static_cast<char>(n >> 8U);
      }
      out += block;
    }
    std::uint32_t a = 1;
    std::uint32_t b = 0;
    for (const char c : content) {
      a = (a + static_cast<unsigned char>(c)) % 65521;
      b = (b + a) % 65521;
    }
    return out + number(b << 16U | a);
  }
  // A zlib stream of some `bytes` that unpacks to 159 times as many zeros: fixed Huffman codes, a
  // zero and then runs of 258 from one byte before, 13 bits each.
  static std::string zlib_bomb(std::size_t bytes) {
    std::string out = "\x78\x01";
    std::uint32_t bits = 0;
    unsigned count = 0;
    const auto put = [&](std::uint32_t value, unsigned size) {
      bits |= value << count;
      for (count += size; count >= 8; count -= 8, bits >>= 8U) out += static_cast<char>(bits);
    };
    put(0b011, 3);       // the last block, fixed codes
    put(0b00001100, 8);  // the byte 0, its code from the left bit on
    std::uint64_t unpacked = 1;
    for (; out.size() < bytes; unpacked += 258) {
      put(0b10100011, 8);  // a run of 258 ...
      put(0, 5);           // ... from one byte before
    }
    put(0, 7);  // the end
    put(0, count == 0 ? 0 : 8 - count);
    return out + number(static_cast<std::uint32_t>(unpacked % 65521) << 16U | 1U);
  }

 private:
  std::string text_ = "\x89PNG\r\n\x1a\n";
};

}  // namespace zenith
