#pragma once
// Words, numbers and punctuation of one line of a DBC file, from left to right. Each take_...()
// skips blanks first, and leaves the rest as it was when it returns empty or false.

#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <system_error>

namespace zenith {

class DbcScanner {
 public:
  explicit DbcScanner(std::string_view line) : rest_(line) {}

  // Letters, digits and underscores.
  std::string_view take_word() {
    skip_blanks();
    std::size_t end = 0;
    while (end < rest_.size() && is_word(rest_[end])) ++end;
    const std::string_view word = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return word;
  }

  bool take(char mark) {
    skip_blanks();
    if (rest_.empty() || rest_.front() != mark) return false;
    rest_.remove_prefix(1);
    return true;
  }

  template <typename Number>
  std::optional<Number> take_number() {
    skip_blanks();
    Number value = 0;
    const std::size_t plus = !rest_.empty() && rest_.front() == '+' ? 1 : 0;
    const char* end = rest_.data() + rest_.size();
    const auto [stop, status] = std::from_chars(rest_.data() + plus, end, value);
    if (status != std::errc()) return std::nullopt;
    rest_.remove_prefix(static_cast<std::size_t>(stop - rest_.data()));
    return value;
  }

  // Between double quotes.
  std::optional<std::string_view> take_quoted() {
    if (!take('"')) return std::nullopt;
    const std::size_t end = rest_.find('"');
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view text = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    return text;
  }

  bool empty() {
    skip_blanks();
    return rest_.empty();
  }

 private:
  static bool is_word(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  }
  void skip_blanks() {
    while (!rest_.empty() && (rest_.front() == ' ' || rest_.front() == '\t')) {
      rest_.remove_prefix(1);
    }
  }

  std::string_view rest_;
};

}  // namespace zenith
