#pragma once
// What a line of the log tells besides its text, for programs that read the journal: which event it
// is, and figures. Plain data. Names are literals in journald's manner: capitals and underscores,
// ZENITH_ first.

#include <cassert>
#include <string_view>

#include "platform/base/fixed_text.h"
#include "platform/base/fixed_vector.h"

namespace zenith {

class LogFields {
 public:
  static constexpr int kNumbers = 6;
  static constexpr std::size_t kTextBytes = 47;  // longer ones are cut

  struct Number {
    const char* name = "";
    double value = 0.0;
  };

  LogFields() = default;
  // ZENITH_EVENT: "camera-lost".
  explicit LogFields(const char* event) : event_(event) {}

  LogFields& number(const char* name, double value) {
    assert(!numbers_.full());
    numbers_.push_back({name, value});
    return *this;
  }
  // One for each line: who it is about.
  LogFields& text(const char* name, std::string_view value) {
    text_name_ = name;
    text_.assign(value);
    return *this;
  }

  const char* event() const { return event_; }  // "": none
  const FixedVector<Number, kNumbers>& numbers() const { return numbers_; }
  const char* text_name() const { return text_name_; }  // "": none
  std::string_view text_value() const { return text_.view(); }

 private:
  const char* event_ = "";
  const char* text_name_ = "";
  FixedText<kTextBytes> text_;
  FixedVector<Number, kNumbers> numbers_;
};

}  // namespace zenith
