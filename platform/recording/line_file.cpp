#include "platform/recording/line_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

constexpr std::size_t kKeep = 32'768;

}  // namespace

LineFile::LineFile(const std::filesystem::path& path)
    : path_(path.string()),
      fd_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)),
      error_(fd_.is_open() ? 0 : errno) {}

void LineFile::add(std::string_view lines) {
  kept_ += lines;
  if (kept_.size() >= kKeep) (void)flush();
}

Status LineFile::flush() {
  std::string_view rest = kept_;
  while (error_ == 0 && !rest.empty()) {
    const ssize_t count = ::write(fd_.get(), rest.data(), rest.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      error_ = count < 0 ? errno : ENOSPC;
      // Back to the last whole line.
      (void)!::ftruncate(fd_.get(), static_cast<off_t>(written_));
      break;
    }
    rest.remove_prefix(static_cast<std::size_t>(count));
  }
  if (error_ == 0) written_ += kept_.size();
  kept_.clear();
  if (error_ == 0) return {};
  return Error{path_ + ": cannot be written: " + errno_text(error_)};
}

}  // namespace zenith
