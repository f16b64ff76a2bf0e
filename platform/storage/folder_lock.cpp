#include "platform/storage/folder_lock.h"

#include <fcntl.h>
#include <pwd.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <string_view>

#include "platform/base/printable.h"
#include "platform/linux/errno_text.h"
#include "platform/storage/folder.h"

namespace zenith::storage {
namespace {

constexpr int kMode = 0600;
constexpr std::size_t kMostText = 256;  // what is read of the file

std::string path_in(const std::string& folder) {
  return folder + "/lock";
}

// Of the whole file, by any program.
struct flock whole_file() {
  struct flock lock = {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

// What "key value" says in one of the lines.
std::string value_of(std::string_view text, std::string_view key) {
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (line.size() <= key.size() || line.substr(0, key.size()) != key) continue;
    if (line[key.size()] == ' ') return std::string(line.substr(key.size() + 1));
  }
  return {};
}

FolderUser read_user(int file) {
  std::array<char, kMostText> bytes;
  const ssize_t count = ::pread(file, bytes.data(), bytes.size(), 0);
  const std::string_view text(bytes.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
  FolderUser user = {0, value_of(text, "program"), value_of(text, "robot")};
  const std::string pid = value_of(text, "pid");
  (void)std::from_chars(pid.data(), pid.data() + pid.size(), user.pid);
  return user;
}

bool write_user(int file, const FolderUser& user) {
  const std::string text = "pid " + std::to_string(user.pid) + "\nprogram " + user.program +
                           "\nrobot " + user.robot + "\n";
  return ::ftruncate(file, 0) == 0 &&
         ::pwrite(file, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
}

LockTry cannot(const std::string& path, const std::string& why) {
  return {LockTry::State::kUnknown, "cannot lock " + path + ": " + why};
}

// Opens it, or makes it for the folder's owner. Never through a link, nor a file that has another
// name elsewhere: it is written to.
UniqueFd open_lock(const std::string& folder, std::string& why) {
  constexpr int kFlags = O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
  const std::string path = path_in(folder);
  UniqueFd file(::open(path.c_str(), kFlags));
  if (!file.is_open() && errno == ENOENT) {
    file.reset(::open(path.c_str(), kFlags | O_CREAT | O_EXCL, kMode));
    if (file.is_open()) give_to_owner_of(folder, file.get());
    if (!file.is_open() && errno == EEXIST) file.reset(::open(path.c_str(), kFlags));
  }
  if (!file.is_open()) {
    why = errno_text(errno) + folder_advice(errno);
    return file;
  }
  struct stat info = {};
  if (::fstat(file.get(), &info) != 0 || !S_ISREG(info.st_mode) || info.st_nlink != 1) {
    why = "expected a regular file with one name; remove it";
    file.reset();
  }
  return file;
}

}  // namespace

FolderUser this_program(const std::string& robot) {
  return {static_cast<int>(::getpid()), program_invocation_short_name, robot};
}

std::string user_text(const FolderUser& user) {
  if (user.pid == 0) return "another program";
  std::string text = printable(user.program) + " (pid " + std::to_string(user.pid);
  if (!user.robot.empty()) text += ", robot " + printable(user.robot);
  return text + ")";
}

LockTry FolderLock::take(const std::string& folder, const FolderUser& self) {
  if (file_.is_open()) return {LockTry::State::kOurs, ""};
  const std::string path = path_in(folder);
  std::string why;
  UniqueFd file = open_lock(folder, why);
  if (!file.is_open()) return cannot(path, why);
  struct flock lock = whole_file();
  if (::fcntl(file.get(), F_OFD_SETLK, &lock) != 0) {
    const int error = errno;
    if (error == EOPNOTSUPP || error == ENOLCK || error == EINVAL || error == ENOSYS) {
      file_ = std::move(file);
      return {LockTry::State::kOurs, folder +
                                         " lies on a file system without locks: see to it "
                                         "that one program alone keeps maps there"};
    }
    if (error != EAGAIN && error != EACCES) return cannot(path, errno_text(error));
    return {LockTry::State::kOthers, folder + " is in use by " + user_text(read_user(file.get())) +
                                         ": one program writes a folder of maps; stop that one, "
                                         "or name another folder"};
  }
  (void)write_user(file.get(), self);  // for people: a full disk is no reason to go without lock
  file_ = std::move(file);
  return {LockTry::State::kOurs, ""};
}

std::optional<FolderUser> user_of(const std::string& folder) {
  const UniqueFd file(
      ::open(path_in(folder).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct flock lock = whole_file();
  if (!file.is_open() || ::fcntl(file.get(), F_OFD_GETLK, &lock) != 0) return std::nullopt;
  if (lock.l_type == F_UNLCK) return std::nullopt;
  return read_user(file.get());
}

FolderFacts look_at_folder(const std::string& folder) {
  FolderFacts facts;
  struct stat info = {};
  facts.exists = ::stat(folder.c_str(), &info) == 0;
  if (!facts.exists) return facts;
  facts.is_folder = S_ISDIR(info.st_mode);
  facts.writable = facts.is_folder && ::access(folder.c_str(), W_OK | X_OK) == 0;
  const passwd* owner = ::getpwuid(info.st_uid);
  facts.owner = owner != nullptr ? owner->pw_name : "user " + std::to_string(info.st_uid);
  struct statvfs disk = {};
  if (::statvfs(folder.c_str(), &disk) == 0) {
    facts.free_mb = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize) * 1e-6;
  }
  facts.user = user_of(folder);
  const std::string lock = path_in(folder);
  facts.lock_is_known = ::access(lock.c_str(), R_OK) == 0 || (errno == ENOENT && facts.is_folder);
  return facts;
}

}  // namespace zenith::storage
