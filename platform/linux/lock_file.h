#pragma once
// A file that stands for something that one program at a time may use. The kernel holds a lock on
// it for as long as that program lives: one that was killed leaves no lock behind.
//
// The kernel locks the file and not its name: whoever may write the folder may remove it, and the
// next program locks a new file of that name. So a lock is worth something as long as the path
// leads to the locked file. take() sees to it; later the owner asks place().

#include <string>

#include "platform/linux/unique_fd.h"

namespace zenith {

class LockFile {
 public:
  enum class State {
    kOurs,
    kOthers,       // another program has it, also of another computer
    kUnsupported,  // the file system has no locks: the file is open, others may have it, too
    kFailed,
  };
  struct Try {
    State state = State::kFailed;
    int error = 0;         // errno of kFailed; 0: something else than a lock's file is there
    bool created = false;  // by this call
    std::string why;       // of kFailed
  };
  // The file is made with rights for its owner alone: who can open it can lock it. Never through a
  // link, nor a file with another name elsewhere, for users write into it. Not while is_open().
  Try take(const std::string& path);

  enum class Place {
    kSame,   // the path leads to the locked file
    kGone,   // to nothing
    kOther,  // to something else, which another program may have locked
  };
  // Only while is_open().
  Place place() const;

  bool is_open() const { return file_.is_open(); }
  int fd() const { return file_.get(); }
  // Gives it up; the file stays, or goes unless it is another one.
  void close() { file_.reset(); }
  void remove();

 private:
  UniqueFd file_;
  std::string path_;
};

// For reading, when a program has it locked; else not open. Takes nothing.
UniqueFd open_locked(const std::string& path);

// Whether the path itself, not what a link leads to, is this open file or folder.
bool leads_to(const std::string& path, int fd);

// Any open file or folder, such as one that is being written. False when a living program holds it,
// also of another computer. Not the lock of a LockFile, which folders cannot have.
bool lock_open(int fd);

}  // namespace zenith
