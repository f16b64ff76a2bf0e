#include "platform/linux/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

constexpr std::size_t kPiece = 64 * 1024;

const char* kind_text(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISSOCK(mode)) return "a socket";
  if (S_ISCHR(mode) || S_ISBLK(mode)) return "a device";
  return "something else";
}

Error cannot_read(const std::string& path, int error) {
  return {path + ": missing or cannot be opened: " + errno_text(error)};
}

Error too_large(const std::string& path, std::uint64_t most, const std::string& found) {
  return {path + ": expected at most " + bytes_text(most) + ", found " + found};
}

Status check_kind(const std::string& path, const struct stat& info) {
  if (S_ISREG(info.st_mode)) return {};
  return Error{path + ": cannot be read: expected a regular file, found " +
               kind_text(info.st_mode)};
}

constexpr std::string_view kMark = "\xef\xbb\xbf";

// That a text does not begin with the mark of UTF-16, in which each second byte is zero.
Status check_encoding(std::string_view text, const std::string& path) {
  const std::string_view begin = text.substr(0, 2);
  if (begin != "\xff\xfe" && begin != "\xfe\xff") return {};
  return Error{path + ": expected a text in UTF-8, found one in UTF-16; please save it as UTF-8"};
}

}  // namespace

std::string bytes_text(std::uint64_t bytes) {
  constexpr const char* kUnits[] = {" bytes", " kB", " MB", " GB"};
  std::size_t unit = 0;
  std::uint64_t rest = 0;
  while (bytes >= 1024 && unit + 1 < std::size(kUnits)) {
    rest = bytes % 1024;
    bytes /= 1024;
    ++unit;
  }
  const std::string tenth = rest == 0 ? "" : "." + std::to_string(rest * 10 / 1024);
  return std::to_string(bytes) + tenth + kUnits[unit];
}

Result<InputFile> open_input(const std::string& path) {
  struct stat info = {};
  if (::stat(path.c_str(), &info) != 0) return cannot_read(path, errno);
  if (const Status kind = check_kind(path, info); !kind) return kind.error();
  InputFile file;
  file.fd.reset(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  // Once more, of what was opened: the path may lead elsewhere in the meantime.
  if (!file.fd.is_open() || ::fstat(file.fd.get(), &info) != 0) return cannot_read(path, errno);
  if (const Status kind = check_kind(path, info); !kind) return kind.error();
  file.bytes = static_cast<std::uint64_t>(info.st_size);
  return file;
}

std::ptrdiff_t read_fully(int fd, char* room, std::size_t bytes) {
  std::size_t size = 0;
  while (size < bytes) {
    const ssize_t count = ::read(fd, room + size, bytes - size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return -1;
    if (count == 0) break;
    size += static_cast<std::size_t>(count);
  }
  return static_cast<std::ptrdiff_t>(size);
}

Result<std::string> read_input(const std::string& path, std::uint64_t most) {
  const auto file = open_input(path);
  if (!file) return file.error();
  if (file->bytes > most) return too_large(path, most, bytes_text(file->bytes));
  std::string text;
  for (;;) {
    // Files of /proc say that they hold nothing: read on until the end shows.
    const std::size_t room = text.empty() ? static_cast<std::size_t>(file->bytes) + 1 : kPiece;
    const std::size_t size = text.size();
    text.resize(size + room);
    const std::ptrdiff_t count = read_fully(file->fd.get(), text.data() + size, room);
    if (count < 0) return cannot_read(path, errno);
    text.resize(size + static_cast<std::size_t>(count));
    if (text.size() > most) return too_large(path, most, "a file that grows");
    if (static_cast<std::size_t>(count) < room) return text;
  }
}

std::string_view without_mark(std::string_view text) {
  return text.substr(text.substr(0, kMark.size()) == kMark ? kMark.size() : 0);
}

Result<std::string> read_text_input(const std::string& path, std::uint64_t most) {
  auto text = read_input(path, most);
  if (!text) return text;
  if (const Status readable = check_encoding(*text, path); !readable) return readable.error();
  text->erase(0, text->size() - without_mark(*text).size());
  return text;
}

Result<InputFile> open_secret(const std::string& path) {
  auto file = open_input(path);
  struct stat info = {};
  if (!file) return file;
  if (::fstat(file->fd.get(), &info) != 0) return cannot_read(path, errno);
  if (info.st_uid != 0 && info.st_uid != ::geteuid()) {
    return Error{path + ": belongs to user " + std::to_string(info.st_uid) +
                 ", who knows it and may change it; please run: chown root " + path};
  }
  constexpr mode_t kOfOthers = S_IRWXO | S_IWGRP | S_IXGRP;
  if ((info.st_mode & kOfOthers) != 0) {
    return Error{path + ": may be read or changed by others than its owner and its group's " +
                 "readers; please run: chmod " + ((info.st_mode & S_IRGRP) != 0 ? "640 " : "600 ") +
                 path};
  }
  return file;
}

Result<InputLines> InputLines::open(const std::string& path, const LineLimits& limits) {
  auto file = open_input(path);
  if (!file) return file.error();
  if (file->bytes > limits.file_bytes) {
    return too_large(path, limits.file_bytes, bytes_text(file->bytes));
  }
  InputLines lines({}, path, limits);
  lines.fd_ = std::move(file->fd);
  return lines;
}

InputLines::InputLines(std::string_view text, std::string name, const LineLimits& limits)
    : name_(std::move(name)), limits_(limits), rest_(text) {}

// Takes the next piece behind what is left of the last one. False at the end of the file.
bool InputLines::refill() {
  if (!fd_.is_open()) return false;
  buffer_.erase(0, at_);
  at_ = 0;
  const std::size_t kept = buffer_.size();
  buffer_.resize(kept + kPiece);
  const std::ptrdiff_t count = read_fully(fd_.get(), buffer_.data() + kept, kPiece);
  if (count < 0) status_ = cannot_read(name_, errno);
  buffer_.resize(kept + static_cast<std::size_t>(std::max<std::ptrdiff_t>(count, 0)));
  read_ += buffer_.size() - kept;
  if (read_ > limits_.file_bytes) {
    status_ = too_large(name_, limits_.file_bytes, "a file that grows");
  }
  return count > 0 && status_.ok();
}

bool InputLines::next(std::string_view& line) {
  if (ended_) return false;
  const auto at_hand = [this] {
    return fd_.is_open() ? std::string_view(buffer_).substr(at_) : rest_;
  };
  std::size_t end = at_hand().find('\n');
  while (end == std::string_view::npos && at_hand().size() <= limits_.line_bytes && refill()) {
    end = at_hand().find('\n');
  }
  const std::string_view left = at_hand();
  const std::size_t size = std::min(end, left.size());
  ended_ = !status_.ok() || left.empty();
  if (ended_) return false;
  ++number_;
  if (size > limits_.line_bytes) {
    status_ = error("expected lines of at most " + std::to_string(limits_.line_bytes) +
                    " bytes, found a longer one: is it a text file?");
    ended_ = true;
    return false;
  }
  line = left.substr(0, size);
  const std::size_t taken = std::min(size + 1, left.size());
  at_ += taken;
  rest_.remove_prefix(fd_.is_open() ? 0 : taken);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  if (number_ == 1) {
    status_ = check_encoding(line, name_);
    line = without_mark(line);
  }
  ended_ = !status_.ok();
  return !ended_;
}

}  // namespace zenith
