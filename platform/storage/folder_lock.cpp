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

constexpr std::size_t kMostText = 256;  // what is read of the file

std::string path_in(const std::string& folder) {
  return folder + "/lock";
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

namespace {

// `created`: it was not there.
LockTry lock_folder(const std::string& folder, const FolderUser& self, LockFile& file,
                    bool& created) {
  const std::string path = path_in(folder);
  const LockFile::Try tried = file.take(path);
  created = tried.created;
  if (created) give_to_owner_of(folder, file.fd());
  switch (tried.state) {
    case LockFile::State::kOurs:
      (void)write_user(file.fd(), self);  // for people: without it on a full disk
      return {LockTry::State::kOurs, ""};
    case LockFile::State::kUnsupported:
      return {LockTry::State::kOurs, folder +
                                         " lies on a file system without locks: see to it "
                                         "that one program alone keeps maps there"};
    case LockFile::State::kOthers:
      return {LockTry::State::kOthers,
              folder + " is in use by " + user_text(user_of(folder).value_or(FolderUser{})) +
                  ": one program writes a folder of maps; stop that one, or name another folder"};
    case LockFile::State::kFailed:
      break;
  }
  return {LockTry::State::kUnknown,
          "cannot lock " + path + ": " + tried.why + folder_advice(tried.error)};
}

}  // namespace

LockTry FolderLock::take(const std::string& folder, const FolderUser& self) {
  if (!lost_.empty()) return {LockTry::State::kOthers, lost_};
  bool created = false;
  if (!file_.is_open()) return lock_folder(folder, self, file_, created);
  if (file_.place() == LockFile::Place::kSame) return {LockTry::State::kOurs, ""};
  return take_again(folder, self);
}

// The file that is ours lies there no more.
LockTry FolderLock::take_again(const std::string& folder, const FolderUser& self) {
  LockFile again;
  bool created = false;
  LockTry tried = lock_folder(folder, self, again, created);
  if (tried.state == LockTry::State::kUnknown) return tried;
  if (created && tried.ours()) {
    file_ = std::move(again);
    return {LockTry::State::kOurs, path_in(folder) + " was removed, and is made anew"};
  }
  again.close();
  const auto user = user_of(folder);
  lost_ = folder + (user ? " is in use by " + user_text(*user) : " was used by another program") +
          ", for its file \"lock\" was exchanged: the maps may be others; stop that program and "
          "start this one again";
  return {LockTry::State::kOthers, lost_};
}

std::optional<FolderUser> user_of(const std::string& folder) {
  const UniqueFd file = open_locked(path_in(folder));
  if (!file.is_open()) return std::nullopt;
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
