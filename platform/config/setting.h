#pragma once
// One key of a TOML file: where its value lives, its unit, range and text. A list of settings is
// all that a file is read by, written from and documented from.
//
// Settings point into the struct whose values they are: it must outlive them and stay in its place.
// For threads without deadlines.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "platform/base/result.h"
#include "platform/config/problems.h"

namespace zenith {

// A value that is one of some words.
struct Choice {
  std::vector<std::string> words;
  std::function<std::size_t()> get;
  std::function<void(std::size_t)> set;
};

// A number, or "auto", which is 0 here and stands beside the range.
struct AutoNumber {
  double* at = nullptr;
};

struct Setting {
  std::string key;  // with its sections: "camera.rate_hz"
  std::string unit;
  double min = 0.0;  // of numbers
  double max = 0.0;
  std::string text;
  // A span: a list of at most so many numbers, behind which there are zeros.
  std::variant<double*, int*, std::uint32_t*, std::uint64_t*, bool*, std::string*,
               std::span<double>, AutoNumber, Choice>
      at;
  bool required = false;  // has no default
  bool live = false;      // may change while the program runs
};

using Settings = std::vector<Setting>;

// Where keys stand in a file; of those that do not, line 0.
class KeyLines {
 public:
  void add(const std::string& key, int line) { lines_[key] = line; }
  int of(const std::string& key) const {
    const auto found = lines_.find(key);
    return found == lines_.end() ? 0 : found->second;
  }

 private:
  std::map<std::string, int> lines_;
};

// A value of an enum, as words in the order of its numbers, which count from 0.
template <typename Enum>
Choice choice_of(Enum& value, std::vector<std::string> words) {
  return {std::move(words), [&value] { return static_cast<std::size_t>(value); },
          [&value](std::size_t i) { value = static_cast<Enum>(i); }};
}

// Reads the file into the settings' values. Keys that are not there keep their values. Everything
// that is wrong is told, each with its line: unknown keys with a guess of what was meant, wrong
// types, values out of range. Relations between keys are the caller's to check; it gets the lines
// of the keys that are there.
KeyLines read_settings(const std::filesystem::path& file, const Settings& settings,
                       Problems& problems);
KeyLines parse_settings(std::string_view text, const Settings& settings, Problems& problems);

// The value, as TOML writes it.
std::string toml_value(const Setting& setting);

// "0.1 .. 5", or the words; empty when there is no range.
std::string range_text(const Setting& setting);

// "camera.rate_hz" -> "camera", "rate_hz"; the section is empty for keys without one.
std::pair<std::string, std::string> split_key(const std::string& key);

}  // namespace zenith
