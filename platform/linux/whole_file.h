#pragma once
// Files that appear whole or not at all, also when the disk is full or the program is killed:
// written under a random name beside the target, synced to the disk, renamed when complete. No link
// that somebody has put there is followed, and nothing that is there is written into.
//
// What a killed program left has a name that partial_name() makes. It is swept away by the next one
// that writes the same target: only what belongs to this user, and no living program has locked.
// For threads without deadlines.

#include <sys/stat.h>

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "platform/base/result.h"
#include "platform/linux/unique_fd.h"

namespace zenith {

struct WholeFile {
  bool replace = true;                // false: a file that is there stays, and is an error
  mode_t mode = 0666;                 // less the umask
  const struct stat* like = nullptr;  // owner, group and rights of this one instead
};

// Replaces regular files and links only. Errors say what happened, without the path.
Status write_whole_file(const std::filesystem::path& path, std::string_view content,
                        const WholeFile& how = {});

// All of it, into an open file. 0, or errno.
int write_all(int fd, std::string_view content);

// --- for output that is more than one file -------------------------------------------------------

// ".NAME" and `kind` and a random number; kinds are kPartial and such. Never "." or a path.
inline constexpr std::string_view kPartial = ".partial-";
std::string partial_name(const std::filesystem::path& target, std::string_view kind);

// Hands to `remove` what killed programs have left of `target`: its path; it is locked meanwhile.
// Nothing in folders where others may give a name to what is not theirs.
void sweep_partial(const std::filesystem::path& target, std::string_view kind,
                   const std::function<void(const std::filesystem::path&)>& remove);

}  // namespace zenith
