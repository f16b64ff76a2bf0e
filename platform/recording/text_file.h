#pragma once
// Text files line by line, with places for error messages.

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>

#include "platform/base/result.h"

namespace zenith {

class TextFile {
 public:
  static Result<TextFile> open(const std::filesystem::path& path) {
    TextFile text(path);
    std::error_code code;
    if (std::filesystem::is_directory(path, code) || !text.file_.is_open()) {
      return Error{path.string() + ": missing or not readable"};
    }
    return text;
  }

  // The next line without its end; false at the end of the file.
  bool next(std::string& line) {
    if (!std::getline(file_, line)) return false;
    ++number_;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return true;
  }

  std::size_t number() const { return number_; }
  // "path:line" of the line that was read last.
  std::string place() const { return path_.string() + ":" + std::to_string(number_); }
  Error error(const std::string& what) const { return {place() + ": " + what}; }

 private:
  explicit TextFile(const std::filesystem::path& path) : path_(path), file_(path) {}

  std::filesystem::path path_;
  std::ifstream file_;
  std::size_t number_ = 0;
};

}  // namespace zenith
