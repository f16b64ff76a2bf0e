#pragma once
// Files that a person names or another program wrote. Whatever stands at the path, reading it takes
// bounded time and memory: a regular file, or a link to one, up to a size that the caller states.
// Pipes and devices are refused without being opened: one waits for ever, another acts on it.
//
// Errors begin with the path. For threads without deadlines.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "platform/base/result.h"
#include "platform/linux/unique_fd.h"

namespace zenith {

struct InputFile {
  UniqueFd fd;
  std::uint64_t bytes = 0;  // when it was opened; what /proc and /sys show says 0, or too much
};

Result<InputFile> open_input(const std::string& path);

// Fills `room`, or less of it at the end of the file. Returns the bytes, or -1 with errno.
std::ptrdiff_t read_fully(int fd, char* room, std::size_t bytes);

// The whole file. One that is larger than `most` is an error and is not read.
Result<std::string> read_input(const std::string& path, std::uint64_t most);

// The same of a text in UTF-8. The mark (BOM) with which some editors begin it is left out; UTF-16
// is an error that says so.
Result<std::string> read_text_input(const std::string& path, std::uint64_t most);
std::string_view without_mark(std::string_view text);

// A regular file that holds a secret, or a link to one: of this user or root, written by its owner
// alone, read by the owner's group at most. The error names the command that mends it.
Result<InputFile> open_secret(const std::string& path);

// "3 MB", for sizes in messages.
std::string bytes_text(std::uint64_t bytes);

// What a program may read line by line.
struct LineLimits {
  std::uint64_t file_bytes = 0;
  std::size_t line_bytes = 4096;
};

// The lines of a file, or of a text that is in memory already, without a mark as above. The memory
// taken is that of a line.
//
//   while (lines.next(line)) ...
//   if (!lines.status()) return lines.status().error();     it ended before its end
class InputLines {
 public:
  static Result<InputLines> open(const std::string& path, const LineLimits& limits);
  // `name` stands for the path in messages. `text` must outlive the lines.
  InputLines(std::string_view text, std::string name, const LineLimits& limits);

  // The next line without its end ("\n" or "\r\n"); valid until the next call. False at the end,
  // and at a line, a file or a disk that is not as it should be: see status().
  bool next(std::string_view& line);
  Status status() const { return status_; }

  const std::string& name() const { return name_; }
  std::size_t number() const { return number_; }
  // "path:line" of the line that was read last.
  std::string place() const { return name_ + ":" + std::to_string(number_); }
  Error error(const std::string& what) const { return {place() + ": " + what}; }

 private:
  bool refill();

  std::string name_;
  LineLimits limits_;
  UniqueFd fd_;             // not open: `rest_` is all there is
  std::string buffer_;      // a piece of the file
  std::size_t at_ = 0;      // in `buffer_`
  std::string_view rest_;   // of a text in memory
  std::uint64_t read_ = 0;  // bytes of the file so far
  std::size_t number_ = 0;
  bool ended_ = false;
  Status status_;
};

}  // namespace zenith
