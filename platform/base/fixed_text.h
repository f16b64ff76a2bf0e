#pragma once
// A short text stored in place, for plain data that carries names. Longer ones are cut.

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace zenith {

template <std::size_t Capacity>
class FixedText {
 public:
  FixedText() = default;
  explicit FixedText(std::string_view text) { assign(text); }

  void assign(std::string_view text) {
    size_ = std::min(text.size(), Capacity);
    std::copy_n(text.data(), size_, text_.data());
    text_[size_] = '\0';
  }
  std::string_view view() const { return {text_.data(), size_}; }
  const char* c_str() const { return text_.data(); }
  bool empty() const { return size_ == 0; }
  bool operator==(const FixedText& other) const { return view() == other.view(); }

 private:
  std::array<char, Capacity + 1> text_ = {};
  std::size_t size_ = 0;
};

}  // namespace zenith
