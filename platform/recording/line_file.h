#pragma once
// A text file that grows line by line for a long time. It holds whole lines at any moment, also
// when the program is killed or the disk is full in the middle of one.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "platform/base/result.h"
#include "platform/linux/unique_fd.h"

namespace zenith {

class LineFile {
 public:
  LineFile() = default;
  // What could not be opened tells so in flush(). `path` names it in messages.
  LineFile(Result<UniqueFd> file, const std::filesystem::path& path);

  bool is_open() const { return fd_.is_open(); }
  // `lines` ends with a line feed. Kept in memory until there are some, or flush().
  void add(std::string_view lines);
  // Writes what is kept. After an error the file stays as it was, and every flush() tells it.
  Status flush();
  std::uint64_t bytes() const { return written_ + kept_.size(); }

 private:
  std::string path_;
  UniqueFd fd_;
  std::string kept_;
  std::uint64_t written_ = 0;
  std::string error_;  // empty: none
};

}  // namespace zenith
