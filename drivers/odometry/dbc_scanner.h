#pragma once
// Words, numbers, texts and punctuation of a DBC file, from left to right. Each take_...() skips
// blanks and line ends first, and leaves the rest as it was when it returns empty or false.
//
// Texts. The format has no way to write a quote in a text, so programs write \" or the bare quote.
// A quote ends a text where what follows can follow it there (TextEnd); any other one is only a
// character, and so is one after a backslash, unless a statement begins behind its semicolon
// ("C:\folder\";).

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <system_error>

namespace zenith {

// What begins a statement.
inline constexpr std::array<std::string_view, 35> kDbcKeywords = {
    "VERSION",
    "NS_",
    "BS_",
    "BU_",
    "BO_",
    "SG_",
    "VAL_TABLE_",
    "BO_TX_BU_",
    "EV_",
    "ENVVAR_DATA_",
    "EV_DATA_",
    "SGTYPE_",
    "SGTYPE_VAL_",
    "SIG_TYPE_REF_",
    "SIG_GROUP_",
    "CM_",
    "BA_DEF_",
    "BA_DEF_REL_",
    "BA_DEF_SGTYPE_",
    "BA_DEF_DEF_",
    "BA_DEF_DEF_REL_",
    "BA_",
    "BA_REL_",
    "BA_SGTYPE_",
    "VAL_",
    "CAT_DEF_",
    "CAT_",
    "FILTER",
    "SIG_VALTYPE_",
    "SIGTYPE_VALTYPE_",
    "SG_MUL_VAL_",
    "BU_SG_REL_",
    "BU_EV_REL_",
    "BU_BO_REL_",
    "NS_DESC_",
};

constexpr bool is_dbc_keyword(std::string_view word) {
  for (const std::string_view keyword : kDbcKeywords) {
    if (word == keyword) return true;
  }
  return false;
}

// What may follow a text.
enum class TextEnd {
  kAny,        // a name or a unit, in one line
  kStatement,  // the end of its statement: a comment, an attribute's value
  kList,       // a comma or the end of its statement
  kTable,      // a number or the end of its statement
};

class DbcScanner {
 public:
  explicit DbcScanner(std::string_view text) : all_(text), rest_(text) {}

  // Letters, digits, underscores, and bytes beyond ASCII.
  std::string_view take_word() {
    skip_blanks();
    return take_front(word_length(rest_));
  }
  std::string_view peek_word() {
    skip_blanks();
    return rest_.substr(0, word_length(rest_));
  }
  // Whatever stands between blanks and the format's marks: other programs' names.
  std::string_view take_name() {
    skip_blanks();
    return take_front(std::min(rest_.find_first_of(" \t\r\n,;:\""), rest_.size()));
  }

  bool take(char mark) {
    skip_blanks();
    if (rest_.empty() || rest_.front() != mark) return false;
    take_front(1);
    return true;
  }
  bool at(char mark) {
    skip_blanks();
    return !rest_.empty() && rest_.front() == mark;
  }

  template <typename Number>
  std::optional<Number> take_number() {
    skip_blanks();
    Number value = 0;
    const std::size_t plus = !rest_.empty() && rest_.front() == '+' ? 1 : 0;
    const char* end = rest_.data() + rest_.size();
    const auto [stop, status] = std::from_chars(rest_.data() + plus, end, value);
    if (status != std::errc()) return std::nullopt;
    take_front(static_cast<std::size_t>(stop - rest_.data()));
    return value;
  }

  // Without its quotes.
  std::optional<std::string_view> take_text(TextEnd end);

  bool empty() {
    skip_blanks();
    return rest_.empty();
  }
  // Blanks are not skipped.
  bool rest_is_empty() const { return rest_.empty(); }
  // The line of the next character, from 1; after take_...(), that of the end of what was taken.
  int line() const { return line_; }
  // Whether nothing but blanks stands before the next word in its line.
  bool begins_line() {
    skip_blanks();
    for (std::size_t i = offset(); i > 0 && all_[i - 1] != '\n'; --i) {
      if (!is_blank(all_[i - 1])) return false;
    }
    return true;
  }
  // What is left of this line, and past its end.
  std::string_view take_line() {
    const std::string_view line = rest_.substr(0, rest_.find('\n'));
    take_front(std::min(line.size() + 1, rest_.size()));
    return line;
  }
  // The next character that is not blank, in its line.
  std::string_view rest_of_line() {
    skip_blanks();
    return rest_.substr(0, rest_.find_first_of("\r\n"));
  }

 private:
  static constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
  static constexpr bool is_word(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           static_cast<unsigned char>(c) >= 0x80;
  }
  static std::size_t word_length(std::string_view text) {
    std::size_t length = 0;
    while (length < text.size() && is_word(text[length])) ++length;
    return length;
  }
  std::size_t offset() const { return all_.size() - rest_.size(); }
  std::string_view take_front(std::size_t size) {
    const std::string_view taken = rest_.substr(0, size);
    for (const char c : taken) line_ += c == '\n' ? 1 : 0;
    rest_.remove_prefix(size);
    return taken;
  }
  void skip_blanks() {
    while (!rest_.empty() && is_blank(rest_.front())) take_front(1);
  }

  std::string_view all_;
  std::string_view rest_;
  int line_ = 1;
};

}  // namespace zenith
