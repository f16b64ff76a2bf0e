#include "platform/linux/lock_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

constexpr int kFlags = O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
constexpr mode_t kOwnerAlone = 0600;

// Of the whole file, by any program.
struct flock whole_file() {
  struct flock lock = {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

// Not open: errno.
UniqueFd open_or_make(const std::string& path, bool& created) {
  UniqueFd file(::open(path.c_str(), kFlags));
  if (file.is_open() || errno != ENOENT) return file;
  file.reset(::open(path.c_str(), kFlags | O_CREAT | O_EXCL, kOwnerAlone));
  created = file.is_open();
  if (!created && errno == EEXIST) file.reset(::open(path.c_str(), kFlags));
  return file;
}

bool has_no_locks(int error) {
  return error == EOPNOTSUPP || error == ENOLCK || error == EINVAL || error == ENOSYS;
}

}  // namespace

LockFile::Try LockFile::take(const std::string& path) {
  constexpr int kTries = 100;  // an owner may remove it while it is waited for
  path_ = path;
  for (int i = 0; i < kTries; ++i) {
    Try tried;
    UniqueFd file = open_or_make(path, tried.created);
    struct stat info = {};
    if (!file.is_open() || ::fstat(file.get(), &info) != 0) {
      tried.error = errno;
      if (tried.error == ENOENT && i + 1 < kTries) continue;
      tried.why = errno_text(tried.error);
      return tried;
    }
    if (!S_ISREG(info.st_mode) || info.st_nlink > 1) {
      tried.why = "expected a regular file with one name; remove it";
      return tried;
    }
    struct flock lock = whole_file();
    if (::fcntl(file.get(), F_OFD_SETLK, &lock) != 0) {
      tried.error = errno;
      if (tried.error == EAGAIN || tried.error == EACCES) {
        tried.state = State::kOthers;
      } else if (has_no_locks(tried.error)) {
        tried.state = State::kUnsupported;
        file_ = std::move(file);
      } else {
        tried.why = errno_text(tried.error);
      }
      return tried;
    }
    file_ = std::move(file);
    if (place() == Place::kSame) {
      tried.state = State::kOurs;
      return tried;
    }
    close();
  }
  Try busy;
  busy.why = "other programs take and leave it all the time";
  return busy;
}

LockFile::Place LockFile::place() const {
  if (leads_to(path_, file_.get())) return Place::kSame;
  struct stat there = {};
  return ::lstat(path_.c_str(), &there) == 0 ? Place::kOther : Place::kGone;
}

void LockFile::remove() {
  if (is_open() && place() == Place::kSame) ::unlink(path_.c_str());
  close();
}

UniqueFd open_locked(const std::string& path) {
  UniqueFd file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct flock lock = whole_file();
  const bool locked =
      file.is_open() && ::fcntl(file.get(), F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
  if (!locked) file.reset();
  return file;
}

bool leads_to(const std::string& path, int fd) {
  struct stat opened = {};
  struct stat there = {};
  return ::fstat(fd, &opened) == 0 && ::lstat(path.c_str(), &there) == 0 &&
         opened.st_dev == there.st_dev && opened.st_ino == there.st_ino;
}

bool lock_open(int fd) {
  return ::flock(fd, LOCK_EX | LOCK_NB) == 0;
}

}  // namespace zenith
