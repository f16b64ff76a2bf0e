#pragma once
// A folder of maps has one program that writes it. Who that is stands in the file "lock", which
// that program has locked (lock_file.h). Asking who has it takes nothing.
//
// Only programs that may write the folder can read or lock the file: others could keep the daemon
// out.

#include <optional>
#include <string>
#include <utility>

#include "platform/linux/lock_file.h"

namespace zenith::storage {

struct FolderUser {
  int pid = 0;
  std::string program;  // "zenithd"
  std::string robot;    // whose map it is; may be empty
};

// This process.
FolderUser this_program(const std::string& robot);
// "zenithd (pid 812, robot ada)", fit for a terminal.
std::string user_text(const FolderUser& user);

struct LockTry {
  enum class State {
    kOurs,
    kOthers,   // another program has the folder
    kUnknown,  // the file cannot be made or locked
  };
  State state = State::kUnknown;
  std::string why;  // what was found and what to do; of kOurs: a warning, or empty

  bool ours() const { return state == State::kOurs; }
};

// One thread.
class FolderLock {
 public:
  // Again at will, for the same folder: after it did not succeed, and before each writing. Somebody
  // may have removed the file meanwhile; then it is made anew, with a warning. Where another file
  // is in its place another program has had the folder, and may have changed what is in it: from
  // then on it is kOthers for good.
  LockTry take(const std::string& folder, const FolderUser& self);

 private:
  LockTry take_again(const std::string& folder, const FolderUser& self);

  LockFile file_;     // open: ours
  std::string lost_;  // to whom; empty: to nobody
};

// Whose folder it is, by the kernel: none when nobody has it, or when the lock cannot be looked at
// by this user. A user without a pid: somebody has it and has not said who yet.
std::optional<FolderUser> user_of(const std::string& folder);

struct FolderFacts {
  bool exists = false;
  bool is_folder = false;
  bool writable = false;  // for this process's user
  std::string owner;      // the user's name, or number
  double free_mb = -1.0;  // for this user; negative: not known
  std::optional<FolderUser> user;
  bool lock_is_known = false;  // false: whether it has a user cannot be seen by this user
};
FolderFacts look_at_folder(const std::string& folder);

}  // namespace zenith::storage
