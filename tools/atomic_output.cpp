#include "tools/atomic_output.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "platform/linux/errno_text.h"
#include "platform/linux/lock_file.h"
#include "platform/linux/whole_file.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kOld = ".old-";  // an older output, while it gives way in two steps

// "dir/name/" names the same folder as "dir/name".
fs::path without_slash(const fs::path& path) {
  const fs::path absolute = fs::absolute(path).lexically_normal();
  return absolute.has_filename() ? absolute : absolute.parent_path();
}

// What processes that were killed have left of this target. Where an older output was about to give
// way and nothing is in its place, it comes back.
void sweep(const fs::path& target) {
  std::error_code ignored;
  sweep_partial(target, kPartial, [&](const fs::path& left) { fs::remove_all(left, ignored); });
  sweep_partial(target, kOld, [&](const fs::path& left) {
    if (fs::exists(fs::symlink_status(target, ignored))) {
      fs::remove_all(left, ignored);
    } else {
      fs::rename(left, target, ignored);
    }
  });
}

UniqueFd open_folder(const fs::path& path) {
  return UniqueFd(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
}

Status check_target(const fs::path& target, bool force, std::string_view marker) {
  std::error_code code;
  const fs::file_status status = fs::symlink_status(target, code);
  if (!fs::exists(status)) return {};
  const std::string name = target.string();
  if (!fs::is_directory(status)) return Error{name + ": exists and is no folder"};
  if (fs::is_empty(target, code)) return {};
  if (!force) return Error{name + ": exists already; use another name, or --force to replace it"};
  if (!fs::exists(target / marker, code)) {
    return Error{name + ": exists and holds no " + std::string(marker) +
                 ", so it was not written by this command; --force replaces only what was"};
  }
  return {};
}

}  // namespace

Result<AtomicFolder> AtomicFolder::create(const fs::path& target, bool force,
                                          std::string_view marker) {
  const fs::path place = without_slash(target);
  std::error_code code;
  fs::create_directories(place.parent_path(), code);
  if (code) {
    return Error{place.parent_path().string() + ": cannot be created: " + code.message()};
  }
  sweep(place);
  if (const Status checked = check_target(place, force, marker); !checked) return checked.error();
  constexpr int kTries = 20;
  for (int i = 0; i < kTries; ++i) {
    const fs::path temporary = place.parent_path() / partial_name(place, kPartial);
    if (!fs::create_directory(temporary, code)) {
      if (!code || code == std::errc::file_exists) continue;
      return Error{temporary.string() + ": cannot be created: " + code.message()};
    }
    UniqueFd lock = open_folder(temporary);
    // Swept by another program before it was locked: once more.
    if (!lock.is_open() || !lock_open(lock.get()) || !leads_to(temporary, lock.get())) {
      continue;
    }
    AtomicFolder made(place, temporary, std::move(lock));
    made.force_ = force;
    made.marker_ = marker;
    return made;
  }
  return Error{place.string() + ": no name beside it is free"};
}

AtomicFolder::AtomicFolder(AtomicFolder&& other) noexcept
    : target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})),
      lock_(std::move(other.lock_)),
      force_(other.force_),
      marker_(std::move(other.marker_)) {
  other.temporary_.clear();
}

AtomicFolder::~AtomicFolder() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
}

Status AtomicFolder::commit(Replace how) {
  ::syncfs(lock_.get());
  if (!leads_to(temporary_, lock_.get())) {
    temporary_.clear();
    return Error{target_.string() +
                 ": somebody has exchanged what was written; nothing was put "
                 "into place"};
  }
  // It may have come, or changed, meanwhile.
  if (const Status checked = check_target(target_, force_, marker_); !checked) return checked;
  std::error_code code;
  if (fs::exists(fs::symlink_status(target_, code))) {
    if (const Status replaced = replace(how); !replaced) return replaced;
  } else if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
    return Error{target_.string() + ": cannot be put into place: " + errno_text(errno)};
  }
  temporary_.clear();
  const UniqueFd parent = open_folder(target_.parent_path());
  if (parent.is_open()) ::fsync(parent.get());
  return {};
}

Status AtomicFolder::replace(Replace how) {
  std::error_code ignored;
  const UniqueFd old_one = open_folder(target_);  // in use as long as it is here
  if (old_one.is_open()) (void)lock_open(old_one.get());
  if (how == Replace::kExchange &&
      ::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) == 0) {
    fs::remove_all(temporary_, ignored);
    return {};
  }
  if (how == Replace::kExchange && errno != EINVAL && errno != ENOSYS && errno != EOPNOTSUPP) {
    return Error{target_.string() + ": cannot be replaced: " + errno_text(errno)};
  }
  const fs::path old_place = target_.parent_path() / partial_name(target_, kOld);
  if (::rename(target_.c_str(), old_place.c_str()) != 0) {
    return Error{target_.string() + ": cannot be replaced: " + errno_text(errno)};
  }
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
    const int error = errno;
    (void)::rename(old_place.c_str(), target_.c_str());
    return Error{target_.string() + ": cannot be put into place: " + errno_text(error)};
  }
  fs::remove_all(old_place, ignored);
  return {};
}

Status write_file(const fs::path& path, std::string_view content) {
  const Status written = write_whole_file(without_slash(path), content);
  return written ? written : Error{path.string() + ": " + written.error().message};
}

}  // namespace zenith::tools
