#pragma once
// TOML files of other people, through toml++: what is too large or nested too deeply for it is an
// error before it parses. Include this instead of toml++/toml.h.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#define TOML_EXCEPTIONS 0
#include <toml++/toml.h>

#include "platform/base/result.h"

namespace zenith {

inline constexpr std::uint64_t kMaxTomlBytes = std::uint64_t{256} << 10U;
inline constexpr std::size_t kMaxKeyDots = 32;  // a.b.c has two

// The text of a regular file of at most kMaxTomlBytes.
Result<std::string> read_toml(const std::filesystem::path& path);

// As toml::parse(). What toml++ does not stand is an error before it: keys with more than
// kMaxKeyDots dots (it makes a table of each part, and the stack does not last to take thousands of
// nested ones apart), headers without a name, brackets that close others, characters outside of
// ASCII in keys and dates and times (it asserts or worse), control characters, bytes that are no
// UTF-8.
toml::parse_result parse_toml(std::string_view text);

// "path:line: what is wrong".
Error toml_error(const std::filesystem::path& path, const toml::parse_error& error);

}  // namespace zenith
