#pragma once
// Collects what is wrong with a file, so that it is told at once, in the order of lines: the first
// hundred problems, and how many there are besides.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "platform/base/result.h"

namespace zenith {

class Problems {
 public:
  explicit Problems(const std::filesystem::path& path) : path_(path.string()) {}

  // Line 0: the file as a whole. A text of several lines is as many problems.
  void add(int line, const std::string& what) {
    const std::string place = path_ + (line > 0 ? ":" + std::to_string(line) : "") + ": ";
    std::size_t begin = 0;
    while (begin <= what.size()) {
      const std::size_t end = std::min(what.find('\n', begin), what.size());
      add_line(line, place + what.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  // About the file as a whole, and names it.
  void add(const Error& error) { add_line(0, error.message); }

  // Checks that `value` is a number in [min, max].
  void check_range(int line, const std::string& key, double value, double min, double max) {
    if (std::isfinite(value) && value >= min && value <= max) return;
    char what[128];
    std::snprintf(what, sizeof what, " is %g, expected %g .. %g", value, min, max);
    add(line, key + what);
  }

  bool any() const { return !lines_.empty(); }
  Error error() const {
    auto sorted = lines_;
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::string text;
    for (const auto& [line, what] : sorted) text += (text.empty() ? "" : "\n") + what;
    if (further_ > 0) text += "\n" + path_ + ": " + std::to_string(further_) + " more problems";
    return {text};
  }

 private:
  static constexpr std::size_t kMost = 100;

  void add_line(int line, std::string text) {
    if (lines_.size() == kMost) {
      ++further_;
    } else {
      lines_.emplace_back(line, std::move(text));
    }
  }

  std::string path_;
  std::vector<std::pair<int, std::string>> lines_;
  std::size_t further_ = 0;
};

}  // namespace zenith
