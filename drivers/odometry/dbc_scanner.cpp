#include "drivers/odometry/dbc_scanner.h"

namespace zenith {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

std::string_view skip_blanks(std::string_view text) {
  return text.substr(std::min(text.find_first_not_of(kBlanks), text.size()));
}

std::string_view first_word(std::string_view text) {
  constexpr std::string_view kWord = "ABCDEFGHIJKLMNOPQRSTUVWXYZ_";
  return text.substr(0, std::min(text.find_first_not_of(kWord), text.size()));
}

// Behind a semicolon.
bool statement_follows(std::string_view text) {
  text = skip_blanks(text);
  return text.empty() || is_dbc_keyword(first_word(text));
}

// Behind a quote: a semicolon that ends the statement. In the middle of a line only a statement
// behind it shows that; and behind an escaped quote, always.
bool ends_statement(std::string_view after, bool escaped) {
  if (after.empty() || after.front() != ';') return false;
  after.remove_prefix(1);
  const std::size_t next = after.find_first_not_of(" \t\r");
  const bool line_ends = next != std::string_view::npos && after[next] == '\n';
  return statement_follows(after) || (line_ends && !escaped);
}

// Whether a quote with `behind` it ends a text.
bool is_end(std::string_view behind, TextEnd end) {
  const std::string_view after = skip_blanks(behind);
  if (end == TextEnd::kAny || after.empty() || ends_statement(after, false)) return true;
  switch (end) {
    case TextEnd::kAny:
      break;
    case TextEnd::kStatement: {
      // A statement that lacks its semicolon: the parser tells.
      const std::string_view between = behind.substr(0, behind.size() - after.size());
      return between.find('\n') != std::string_view::npos && statement_follows(after);
    }
    case TextEnd::kList:
      return after.front() == ',' || after.front() == ';';
    case TextEnd::kTable:
      return std::string_view("0123456789+-.;").find(after.front()) != std::string_view::npos;
  }
  return false;
}

// Whether a line of a text, but for its first, looks like a statement.
bool holds_statement(std::string_view text) {
  for (std::size_t at = text.find('\n'); at != std::string_view::npos;
       at = text.find('\n', at + 1)) {
    const std::string_view line = text.substr(at + 1);
    const std::size_t begin = std::min(line.find_first_not_of(" \t"), line.size());
    if (is_dbc_keyword(first_word(line.substr(begin)))) return true;
  }
  return false;
}

}  // namespace

std::optional<std::string_view> DbcScanner::take_text(TextEnd end) {
  skip_blanks();
  if (rest_.empty() || rest_.front() != '"') return std::nullopt;
  bool bare_quote = false;
  for (std::size_t at = rest_.find('"', 1); at != std::string_view::npos;
       at = rest_.find('"', at + 1)) {
    const std::string_view text = rest_.substr(1, at - 1);
    if (end == TextEnd::kAny && text.find('\n') != std::string_view::npos) return std::nullopt;
    const bool escaped = !text.empty() && text.back() == '\\';
    const std::string_view behind = rest_.substr(at + 1);
    if (escaped ? !ends_statement(zenith::skip_blanks(behind), true) : !is_end(behind, end)) {
      bare_quote = bare_quote || !escaped;
      continue;
    }
    // Did a quote that is missing at the end make one text out of several?
    if (bare_quote && holds_statement(text)) return std::nullopt;
    take_front(at + 1);
    return text;
  }
  return std::nullopt;
}

}  // namespace zenith
