#include "platform/recording/line_file.h"

#include <unistd.h>

#include <utility>

#include "platform/linux/errno_text.h"
#include "platform/linux/whole_file.h"

namespace zenith {
namespace {

constexpr std::size_t kKeep = 32'768;

}  // namespace

LineFile::LineFile(Result<UniqueFd> file, const std::filesystem::path& path)
    : path_(path.string()), error_(file ? std::string() : file.error().message) {
  if (file) fd_ = std::move(*file);
}

void LineFile::add(std::string_view lines) {
  kept_ += lines;
  if (kept_.size() >= kKeep) (void)flush();
}

Status LineFile::flush() {
  if (error_.empty()) {
    if (const int error = write_all(fd_.get(), kept_); error != 0) {
      error_ = path_ + ": cannot be written: " + errno_text(error);
      // Back to the last whole line.
      (void)!::ftruncate(fd_.get(), static_cast<off_t>(written_));
    }
  }
  if (error_.empty()) written_ += kept_.size();
  kept_.clear();
  return error_.empty() ? Status() : Error{error_};
}

}  // namespace zenith
