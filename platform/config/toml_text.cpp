#include "platform/config/toml_text.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "platform/base/printable.h"
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

// What toml++ must not see, and where.
struct Unfit {
  std::size_t at = 0;
  std::string what;
};

// toml++ takes for granted that a header goes on with a key.
bool begins_header(std::string_view text, std::size_t at) {
  const bool twice = text.substr(at, 2) == "[[";
  at += twice ? 2 : 1;
  at = std::min(text.find_first_not_of(" \t", at), text.size());
  if (at == text.size()) return true;
  const char c = text[at];
  return is_key_character(c) || c == '"' || c == '\'' || c == ']' || (c == '[' && !twice);
}

std::optional<Unfit> find_unfit(std::string_view text) {
  std::size_t dots = 0;  // of the key at hand
  std::string open;      // brackets and braces
  bool line_begins = true;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '[' && line_begins && open.empty() && !begins_header(text, i)) {
      return Unfit{i, "expected a section's name behind ["};
    }
    if (c == '"' || c == '\'') {
      i = end_of_string(text, i) - 1;
      if (text[i] == '\n') dots = 0;
    } else if (c == '#') {
      i = std::min(text.find('\n', i), text.size()) - 1;
      dots = 0;
    } else if (c == '.') {
      if (++dots > kMaxKeyDots) {
        return Unfit{i, "a key with more than " + std::to_string(kMaxKeyDots) + " dots"};
      }
    } else if ((static_cast<unsigned char>(c) & 0x80U) != 0) {
      return Unfit{i, "a character outside of ASCII that stands in no quotes"};
    } else if (!is_key_character(c)) {
      dots = 0;
    }
    if (c == '[' || c == '{') open += c;
    if ((c == ']' || c == '}') && !open.empty()) {
      if (open.back() != (c == ']' ? '[' : '{')) {
        return Unfit{i, std::string("expected the end of ") + open.back() + ", found " + c};
      }
      open.pop_back();
    }
    line_begins = text[i] == '\n' || (line_begins && (c == ' ' || c == '\t'));
  }
  return std::nullopt;
}

// Within comments and strings, too.
std::optional<Unfit> find_control_character(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const Utf8Character character = first_character(text.substr(at));
    const std::uint32_t code = character.code;
    if (!character.valid) return Unfit{at, "a byte that is no UTF-8"};
    const bool blank = code == '\t' || code == '\n' || code == '\r';
    if ((code < 0x20 && !blank) || code == 0x7f) return Unfit{at, "a control character"};
    at += character.size;
  }
  return std::nullopt;
}

}  // namespace

Result<std::string> read_toml(const std::filesystem::path& path) {
  return read_input(path.string(), kMaxTomlBytes);
}

toml::parse_result parse_toml(std::string_view text) {
  auto unfit = find_control_character(text);
  if (!unfit) unfit = find_unfit(text);
  if (!unfit) return toml::parse(text);
  const std::string_view before = text.substr(0, unfit->at);
  const auto lines = std::count(before.begin(), before.end(), '\n');
  const toml::source_position place = {static_cast<toml::source_index>(lines + 1), 1};
  return toml::parse_result(toml::parse_error(std::move(unfit->what), place));
}

Error toml_error(const std::filesystem::path& path, const toml::parse_error& error) {
  return {path.string() + ":" + std::to_string(error.source().begin.line) + ": " +
          std::string(error.description())};
}

}  // namespace zenith
