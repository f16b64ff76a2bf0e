#pragma once
// One JSON object on one line, written into a fixed place: flat keys, numbers, texts, and arrays of
// them. No number that JSON lacks is written: nan and infinity become null. Of texts, whoever they
// are of, only what a terminal may get: other characters and bytes become blanks.

#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "platform/base/printable.h"

namespace zenith {

template <std::size_t Room>
class BasicJsonLine {
 public:
  BasicJsonLine() { put("{"); }

  BasicJsonLine& text(std::string_view key, std::string_view value) {
    name(key);
    quoted(value);
    return *this;
  }
  BasicJsonLine& number(std::string_view key, double value) {
    name(key);
    digits(value);
    return *this;
  }
  BasicJsonLine& count(std::string_view key, unsigned long long value) {
    name(key);
    whole(value);
    return *this;
  }
  BasicJsonLine& flag(std::string_view key, bool value) {
    name(key);
    put(value ? "true" : "false");
    return *this;
  }
  template <typename Numbers>
  BasicJsonLine& numbers(std::string_view key, const Numbers& values) {
    name(key);
    put("[");
    bool first = true;
    for (const double value : values) {
      if (!first) put(",");
      first = false;
      digits(value);
    }
    put("]");
    return *this;
  }

  // Objects within: begin(key) ... end().
  BasicJsonLine& begin(std::string_view key) {
    name(key);
    put("{");
    comma_ = false;
    return *this;
  }
  BasicJsonLine& end() {
    put("}");
    comma_ = true;
    return *this;
  }

  // The whole line with its end. Empty when it did not fit.
  std::string_view finish() {
    put("}\n");
    return fits_ ? std::string_view(text_.data(), size_) : std::string_view();
  }

 private:
  void name(std::string_view key) {
    if (comma_) put(",");
    comma_ = true;
    quoted(key);
    put(":");
  }
  void quoted(std::string_view value) {
    put("\"");
    while (!value.empty()) {
      const Utf8Character character = first_character(value);
      if (value[0] == '"' || value[0] == '\\') put("\\");
      put(is_printable(character) ? value.substr(0, character.size) : " ");
      value.remove_prefix(character.size);
    }
    put("\"");
  }
  void digits(double value) {
    if (!std::isfinite(value)) return put("null");
    std::array<char, 32> number;
    const int length = std::snprintf(number.data(), number.size(), "%.9g", value);
    put({number.data(), static_cast<std::size_t>(length)});
  }
  void whole(unsigned long long value) {
    std::array<char, 24> number;
    const int length = std::snprintf(number.data(), number.size(), "%llu", value);
    put({number.data(), static_cast<std::size_t>(length)});
  }
  void put(std::string_view piece) {
    fits_ = fits_ && piece.size() <= text_.size() - size_;
    if (fits_) size_ += piece.copy(text_.data() + size_, piece.size());
  }

  std::array<char, Room> text_;
  std::size_t size_ = 0;
  bool comma_ = false;
  bool fits_ = true;
};

using JsonLine = BasicJsonLine<4096>;
// With a line of text for each code of a verdict.
using VerdictLine = BasicJsonLine<12288>;

}  // namespace zenith
