// Comments and literals out of C++ text, line by line.

#include <algorithm>
#include <cctype>

#include "tests/support/architecture_rules.h"

namespace zenith {
namespace {

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

// Reads one literal or comment that begins at `i` and returns where it ends. Raw strings end at
// the first )" with the same delimiter.
std::size_t end_of_raw_string(std::string_view s, std::size_t i) {
  const std::size_t open = s.find('(', i);
  if (open == std::string_view::npos) return s.size();
  const std::string close = ")" + std::string(s.substr(i + 2, open - i - 2)) + "\"";
  const std::size_t end = s.find(close, open);
  return end == std::string_view::npos ? s.size() : end + close.size();
}

std::size_t end_of_quoted(std::string_view s, std::size_t i) {
  const char quote = s[i];
  for (++i; i < s.size() && s[i] != quote && s[i] != '\n'; ++i) {
    if (s[i] == '\\') ++i;
  }
  return std::min(i + 1, s.size());
}

std::size_t end_of_block_comment(std::string_view s, std::size_t i) {
  const std::size_t end = s.find("*/", i + 2);
  return end == std::string_view::npos ? s.size() : end + 2;
}

bool on_include_line(std::string_view s, std::size_t i) {
  const std::size_t newline = s.rfind('\n', i);
  const std::size_t begin = newline == std::string_view::npos ? 0 : newline + 1;
  const std::string_view before = s.substr(begin, i - begin);
  const std::size_t hash = before.find_first_not_of(" \t");
  return hash != std::string_view::npos && before[hash] == '#' &&
         before.find("include") != std::string_view::npos;
}

}  // namespace

std::string strip_comments_and_literals(std::string_view s) {
  std::string out;
  out.reserve(s.size());
  std::size_t i = 0;
  while (i < s.size()) {
    const char c = s[i];
    const char next = i + 1 < s.size() ? s[i + 1] : '\0';
    const bool after_word = i > 0 && is_word(s[i - 1]);
    std::size_t end = i;
    if (c == '/' && next == '/') {
      end = std::min(s.find('\n', i), s.size());
    } else if (c == '/' && next == '*') {
      end = end_of_block_comment(s, i);
    } else if (c == 'R' && next == '"' && !after_word) {
      end = end_of_raw_string(s, i);
    } else if ((c == '"' && !on_include_line(s, i)) || (c == '\'' && !after_word)) {
      end = end_of_quoted(s, i);
    }
    if (end == i) {
      out += c;
      ++i;
      continue;
    }
    out += ' ';
    for (; i < end; ++i) {
      if (s[i] == '\n') out += '\n';
    }
  }
  return out;
}

}  // namespace zenith
