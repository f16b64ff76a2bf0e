#include "platform/config/toml_text.h"

#include <algorithm>
#include <optional>

#include "platform/linux/input_file.h"

namespace zenith {
namespace {

bool is_key_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-' || c == ' ' || c == '\t';
}

// Where the string that begins at `start` is over; the end of the text when it never is.
std::size_t end_of_string(std::string_view text, std::size_t start) {
  const char quote = text[start];
  const bool escapes = quote == '"';
  const std::string three(3, quote);
  const bool many_lines = text.substr(start, 3) == three;
  for (std::size_t i = start + (many_lines ? 3 : 1); i < text.size(); ++i) {
    if (escapes && text[i] == '\\') {
      ++i;
    } else if (many_lines) {
      if (text.substr(i, 3) == three) return i + 3;
    } else if (text[i] == quote || text[i] == '\n') {
      return i + 1;
    }
  }
  return text.size();
}

// Where a key goes beyond kMaxKeyDots.
std::optional<std::size_t> find_deep_key(std::string_view text) {
  std::size_t dots = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      i = end_of_string(text, i) - 1;
      if (text[i] == '\n') dots = 0;
    } else if (c == '#') {
      i = std::min(text.find('\n', i), text.size() - 1);
      dots = 0;
    } else if (c == '.') {
      if (++dots > kMaxKeyDots) return i;
    } else if (!is_key_character(c)) {
      dots = 0;
    }
  }
  return std::nullopt;
}

}  // namespace

Result<std::string> read_toml(const std::filesystem::path& path) {
  return read_input(path.string(), kMaxTomlBytes);
}

toml::parse_result parse_toml(std::string_view text) {
  const auto deep = find_deep_key(text);
  if (!deep) return toml::parse(text);
  const auto lines =
      std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(*deep), '\n');
  const toml::source_position place = {static_cast<toml::source_index>(lines + 1), 1};
  return toml::parse_result(
      toml::parse_error("a key with more than " + std::to_string(kMaxKeyDots) + " dots", place));
}

Error toml_error(const std::filesystem::path& path, const toml::parse_error& error) {
  return {path.string() + ":" + std::to_string(error.source().begin.line) + ": " +
          std::string(error.description())};
}

}  // namespace zenith
