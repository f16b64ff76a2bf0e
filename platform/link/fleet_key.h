#pragma once
// What all robots of a fleet share: a secret key, and for the time of a change a second one.
//
// The file, readable by its owner and at most its group:
//
//   zenith-fleet-key 1
//   5Yq0...=                    32 bytes as base64 or 64 hex digits: seals and opens
//   1fZs...=                    if there: the previous key, or the next one, which only opens
//
// Empty lines and lines that begin with # are passed over. Keys are wiped from memory when they are
// no longer used. For threads without deadlines.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "platform/base/result.h"

namespace zenith {

// Chooses the code that suits this processor. Any thread, any number of times.
void prepare_cryptography();

// That nobody can guess.
std::uint64_t secret_number();

// 32 secret bytes. Every copy wipes itself at its end.
class SecretKey {
 public:
  static constexpr std::size_t kBytes = 32;

  SecretKey() = default;
  SecretKey(const SecretKey&) = default;
  SecretKey& operator=(const SecretKey&) = default;
  ~SecretKey();

  std::span<std::uint8_t, kBytes> bytes() { return bytes_; }
  std::span<const std::uint8_t, kBytes> bytes() const { return bytes_; }
  bool operator==(const SecretKey& other) const;

  static SecretKey random();

 private:
  std::array<std::uint8_t, kBytes> bytes_ = {};
};

struct FleetKeys {
  SecretKey current;
  SecretKey previous;  // or the next one; it opens, and does not seal
  bool has_previous = false;
};

using KeyHint = std::array<std::uint8_t, 2>;

// Tells keys apart without giving them away.
KeyHint key_hint(const SecretKey& fleet_key);
std::string hint_text(const KeyHint& hint);  // "3fa0"
// "3fa0; 77b1 only opens"
std::string keys_text(const FleetKeys& keys);

// An error names the file, what is wrong with it, and the command that mends it.
Result<FleetKeys> read_fleet_keys(const std::filesystem::path& file);

// A file of a new key. One that is there already stays, and is an error.
Status create_fleet_key(const std::filesystem::path& file);

// A new key in front of the present one. The file is replaced as a whole, with the same owner and
// rights. A link is refused.
Status rotate_fleet_key(const std::filesystem::path& file);

// Of two keys the one that only opened seals from now on, and the other way round. The file is
// replaced likewise.
Status swap_fleet_keys(const std::filesystem::path& file);

}  // namespace zenith
