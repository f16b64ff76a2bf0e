#include "platform/storage/folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>

#include "platform/linux/errno_text.h"
#include "platform/linux/input_file.h"

namespace zenith::storage {
namespace {

constexpr int kMode = 0640;

Error error_of(const std::string& what, const std::string& path, int error) {
  return Error{what + " " + path + ": " + errno_text(error) + folder_advice(error)};
}

}  // namespace

std::string folder_advice(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "; make room on the disk";
    case EROFS:
      return "; the file system is read-only: mount it for writing, or name another map.folder";
    case EACCES:
    case EPERM:
      return "; the service's user must own the folder";
    default:
      return {};
  }
}

void give_to_owner_of(const std::string& folder, int file) {
  struct stat info = {};
  if (::geteuid() != 0 || ::stat(folder.c_str(), &info) != 0) return;
  (void)!::fchown(file, info.st_uid, info.st_gid);
}

bool DiskFolder::exists(const std::string& name) {
  struct stat info = {};
  return ::lstat(path_of(name).c_str(), &info) == 0 || (errno != ENOENT && errno != ENOTDIR);
}

Result<std::vector<std::uint8_t>> DiskFolder::read(const std::string& name, std::size_t most) {
  const std::string path = path_of(name);
  const auto file = open_input(path);
  if (!file) return Error{"cannot read " + file.error().message};
  std::vector<std::uint8_t> bytes(std::min<std::uint64_t>(most + 1, file->bytes));
  const std::ptrdiff_t size =
      read_fully(file->fd.get(), reinterpret_cast<char*>(bytes.data()), bytes.size());
  if (size < 0) return error_of("cannot read", path, errno);
  bytes.resize(static_cast<std::size_t>(size));
  return bytes;
}

Status DiskFolder::create(const std::string& name) {
  open_ = path_of(name);
  // Never what is there already, which may be a link or have another name elsewhere.
  (void)::unlink(open_.c_str());
  file_.reset(::open(open_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, kMode));
  if (!file_.is_open()) return error_of("cannot write", open_, errno);
  give_to_owner_of(path_, file_.get());
  return {};
}

Status DiskFolder::write(Bytes bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file_.get(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return error_of("cannot write", open_, errno);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return {};
}

Status DiskFolder::sync() {
  if (::fsync(file_.get()) != 0) return error_of("cannot write", open_, errno);
  return {};
}

Status DiskFolder::rename(const std::string& from, const std::string& to) {
  if (std::rename(path_of(from).c_str(), path_of(to).c_str()) != 0) {
    return error_of("cannot rename " + path_of(from) + " to", path_of(to), errno);
  }
  return {};
}

Status DiskFolder::remove(const std::string& name) {
  if (::unlink(path_of(name).c_str()) != 0 && errno != ENOENT) {
    return error_of("cannot remove", path_of(name), errno);
  }
  return {};
}

Status DiskFolder::sync_folder() {
  const UniqueFd folder(::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!folder.is_open()) return error_of("cannot open", path_, errno);
  // Some file systems have nothing to sync a folder for, and say so.
  if (::fsync(folder.get()) != 0 && errno != EINVAL) return error_of("cannot sync", path_, errno);
  return {};
}

}  // namespace zenith::storage
