#pragma once
// Collects everything that is wrong with a file, so that it is told at once.

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

#include "platform/base/result.h"

namespace zenith {

class Problems {
 public:
  explicit Problems(const std::filesystem::path& path) : path_(path.string()) {}

  // Line 0: the file as a whole.
  void add(int line, const std::string& what) {
    text_ += (text_.empty() ? "" : "\n") + path_ + (line > 0 ? ":" + std::to_string(line) : "") +
             ": " + what;
  }

  // Checks that `value` is a number in [min, max].
  void check_range(int line, const std::string& key, double value, double min, double max) {
    if (std::isfinite(value) && value >= min && value <= max) return;
    char what[128];
    std::snprintf(what, sizeof what, " is %g, expected %g .. %g", value, min, max);
    add(line, key + what);
  }

  bool any() const { return !text_.empty(); }
  Error error() const { return {text_}; }

 private:
  std::string path_;
  std::string text_;
};

}  // namespace zenith
