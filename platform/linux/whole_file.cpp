#include "platform/linux/whole_file.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <sys/random.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <memory>

#include "platform/linux/errno_text.h"
#include "platform/linux/lock_file.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;

struct Folder {
  UniqueFd fd;
  fs::path path;
};

// By its descriptor: it is the same one until the end, whatever happens to its path.
Folder folder_of(const fs::path& path) {
  const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
  return {UniqueFd(::open(parent.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC)), parent};
}

Error error_now() {
  return Error{"cannot be written: " + errno_text(errno)};
}

// What is there may be replaced as a whole, or nothing is.
Status check_target(const Folder& folder, const std::string& name, const WholeFile& how) {
  struct stat there = {};
  if (::fstatat(folder.fd.get(), name.c_str(), &there, AT_SYMLINK_NOFOLLOW) != 0) {
    return errno == ENOENT ? Status() : Status(error_now());
  }
  if (!how.replace) return Error{"is there already and stays"};
  if (S_ISREG(there.st_mode) || S_ISLNK(there.st_mode)) return {};
  return Error{S_ISDIR(there.st_mode) ? "is a folder" : "is no regular file"};
}

// A new file, locked. Its name is in `name` then.
Result<UniqueFd> create_partial(const Folder& folder, const std::string& target, mode_t mode,
                                std::string& name) {
  constexpr int kTries = 20;
  for (int i = 0; i < kTries; ++i) {
    name = partial_name(target, kPartial);
    UniqueFd fd(::openat(folder.fd.get(), name.c_str(),
                         O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode));
    if (!fd.is_open() && errno == EEXIST) continue;
    if (!fd.is_open()) return error_now();
    struct stat made = {};
    // Swept by another program before it was locked: once more.
    if (lock_open(fd.get()) && ::fstat(fd.get(), &made) == 0 && made.st_nlink > 0) return fd;
  }
  return Error{"cannot be written: no name beside it is free"};
}

Status fill(int fd, std::string_view content, const struct stat* like) {
  if (like != nullptr &&
      (::fchown(fd, like->st_uid, like->st_gid) != 0 || ::fchmod(fd, like->st_mode & 07777) != 0)) {
    return error_now();
  }
  if (write_all(fd, content) != 0 || ::fsync(fd) != 0) return error_now();
  return {};
}

Status put_into_place(const Folder& folder, const std::string& from, const std::string& to,
                      bool replace) {
  const int at = folder.fd.get();
  if (replace) {
    return ::renameat(at, from.c_str(), at, to.c_str()) == 0 ? Status() : Status(error_now());
  }
  if (::renameat2(at, from.c_str(), at, to.c_str(), RENAME_NOREPLACE) == 0) return {};
  // Not every filesystem knows it.
  if (errno == EINVAL && ::linkat(at, from.c_str(), at, to.c_str(), 0) == 0) {
    ::unlinkat(at, from.c_str(), 0);
    return {};
  }
  return errno == EEXIST ? Error{"is there already and stays"} : error_now();
}

void sync_folder(const Folder& folder) {
  const UniqueFd fd(::openat(folder.fd.get(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.is_open()) ::fsync(fd.get());
}

// Whether a name in it that is this user's was given by this user or root.
bool names_are_ours(const struct stat& folder) {
  const bool shared = (folder.st_mode & (S_IWGRP | S_IWOTH)) != 0;
  return (folder.st_uid == 0 || folder.st_uid == ::geteuid()) &&
         (!shared || (folder.st_mode & S_ISVTX) != 0);
}

}  // namespace

int write_all(int fd, std::string_view content) {
  while (!content.empty()) {
    const ssize_t count = ::write(fd, content.data(), content.size());
    if (count < 0 && errno == EINTR) continue;
    if (count == 0) errno = ENOSPC;
    if (count <= 0) return errno;
    content.remove_prefix(static_cast<std::size_t>(count));
  }
  return 0;
}

std::string partial_name(const fs::path& target, std::string_view kind) {
  std::uint64_t number = 0;
  (void)!::getrandom(&number, sizeof number, 0);
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(number));
  return "." + target.filename().string() + std::string(kind) + digits;
}

void sweep_partial(const fs::path& target, std::string_view kind,
                   const std::function<void(const fs::path&)>& remove) {
  const Folder folder = folder_of(target);
  struct stat info = {};
  if (!folder.fd.is_open() || ::fstat(folder.fd.get(), &info) != 0 || !names_are_ours(info)) return;
  const std::string prefix = "." + target.filename().string() + std::string(kind);
  UniqueFd listed(::openat(folder.fd.get(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!listed.is_open()) return;
  const auto close = [](DIR* dir) { ::closedir(dir); };
  const std::unique_ptr<DIR, decltype(close)> dir(::fdopendir(listed.get()), close);
  if (dir == nullptr) return;
  (void)listed.release();
  while (const dirent* entry = ::readdir(dir.get())) {
    if (std::string_view(entry->d_name).substr(0, prefix.size()) != prefix) continue;
    const UniqueFd fd(
        ::openat(folder.fd.get(), entry->d_name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    const bool ours = fd.is_open() && ::fstat(fd.get(), &info) == 0 && info.st_uid == ::geteuid() &&
                      (S_ISREG(info.st_mode) || S_ISDIR(info.st_mode));
    if (ours && lock_open(fd.get())) remove(folder.path / entry->d_name);
  }
}

Status write_whole_file(const fs::path& path, std::string_view content, const WholeFile& how) {
  const Folder folder = folder_of(path);
  const std::string target = path.filename().string();
  if (!folder.fd.is_open()) return error_now();
  if (target.empty() || target == "." || target == "..") return Error{"is no file's name"};
  if (const Status free = check_target(folder, target, how); !free) return free;
  sweep_partial(path, kPartial, [](const fs::path& left) { ::unlink(left.c_str()); });
  constexpr mode_t kOwnerAlone = 0600;  // until it is as it shall be
  std::string name;
  auto file = create_partial(folder, target, how.like != nullptr ? kOwnerAlone : how.mode, name);
  if (!file) return file.error();
  Status done = fill(file->get(), content, how.like);
  if (done) done = put_into_place(folder, name, target, how.replace);
  if (!done) {
    ::unlinkat(folder.fd.get(), name.c_str(), 0);
    return done;
  }
  sync_folder(folder);
  return {};
}

}  // namespace zenith
