#include "platform/linux/new_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "platform/linux/errno_text.h"
#include "platform/linux/whole_file.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;

bool is_one_step(const std::string& name) {
  return !name.empty() && name != "." && name != ".." &&
         name.find_first_of(std::string_view("/\0", 2)) == std::string::npos;
}

}  // namespace

Result<NewFolder> NewFolder::make_at(int parent, const std::string& name, const fs::path& path) {
  const auto failed = [&path](const std::string& why) {
    return Error{path.string() + ": cannot be made: " + why};
  };
  if (!is_one_step(name)) return failed("that is no folder's name");
  if (::mkdirat(parent, name.c_str(), 0777) != 0) return failed(errno_text(errno));
  UniqueFd fd(::openat(parent, name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  struct stat made = {};
  if (!fd.is_open() || ::fstat(fd.get(), &made) != 0) return failed(errno_text(errno));
  // In a folder that others may change they can have put one of theirs there meanwhile.
  if (made.st_uid != ::geteuid()) return failed("somebody exchanges it");
  return NewFolder(std::move(fd), path);
}

Result<NewFolder> NewFolder::make(const fs::path& path) {
  std::error_code code;
  fs::path whole = fs::absolute(path, code).lexically_normal();
  if (!whole.has_filename()) whole = whole.parent_path();  // "rec/" is "rec"
  const fs::path parent = whole.parent_path();
  if (!code) fs::create_directories(parent, code);
  if (code) return Error{parent.string() + ": cannot be made: " + code.message()};
  const UniqueFd fd(::open(parent.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (!fd.is_open()) return Error{parent.string() + ": " + errno_text(errno)};
  return make_at(fd.get(), whole.filename().string(), path);
}

Result<NewFolder> NewFolder::make_folder(const std::string& name) const {
  return make_at(fd_.get(), name, path_ / name);
}

Result<UniqueFd> NewFolder::create_file(const std::string& name) const {
  const std::string path = (path_ / name).string();
  if (!is_one_step(name)) return Error{path + ": cannot be created: that is no file's name"};
  UniqueFd fd(::openat(fd_.get(), name.c_str(),
                       O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (!fd.is_open()) return Error{path + ": cannot be created: " + errno_text(errno)};
  return fd;
}

Status NewFolder::write_file(const std::string& name, std::string_view content) const {
  const auto fd = create_file(name);
  if (!fd) return fd.error();
  const int error = write_all(fd->get(), content);
  if (error == 0) return {};
  return Error{(path_ / name).string() + ": cannot be written: " + errno_text(error)};
}

void NewFolder::remove_file(const std::string& name) const {
  ::unlinkat(fd_.get(), name.c_str(), 0);
}

}  // namespace zenith
