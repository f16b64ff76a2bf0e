#include "tools/atomic_output.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <fstream>
#include <utility>

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPartial = ".partial-";

std::string temporary_name(const fs::path& target, std::string_view kind) {
  return "." + target.filename().string() + std::string(kind) + std::to_string(getpid());
}

// "dir/name/" names the same folder as "dir/name".
fs::path without_slash(const fs::path& path) {
  const fs::path absolute = fs::absolute(path).lexically_normal();
  return absolute.has_filename() ? absolute : absolute.parent_path();
}

// Removes what processes that no longer live have left of this target.
void sweep(const fs::path& target) {
  const std::string prefix = "." + target.filename().string() + std::string(kPartial);
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(target.parent_path(), ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(prefix, 0) != 0) continue;
    pid_t pid = 0;
    const char* end = name.data() + name.size();
    const auto parsed = std::from_chars(name.data() + prefix.size(), end, pid);
    if (parsed.ec != std::errc() || parsed.ptr != end || pid <= 0) continue;
    if (kill(pid, 0) == 0 || errno != ESRCH) continue;
    fs::remove_all(entry.path(), ignored);
  }
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

void sync_path(const fs::path& path, bool whole_filesystem) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return;
  if (whole_filesystem) {
    syncfs(file);
  } else {
    fsync(file);
  }
  close(file);
}

}  // namespace

Result<AtomicFolder> AtomicFolder::create(const fs::path& target, bool force,
                                          std::string_view marker) {
  const fs::path place = without_slash(target);
  if (const Status checked = check_target(place, force, marker); !checked) return checked.error();
  std::error_code code;
  fs::create_directories(place.parent_path(), code);
  if (code) {
    return Error{place.parent_path().string() + ": cannot be created: " + code.message()};
  }
  sweep(place);
  const fs::path temporary = place.parent_path() / temporary_name(place, kPartial);
  fs::remove_all(temporary, code);
  if (!fs::create_directory(temporary, code)) {
    return Error{temporary.string() + ": cannot be created: " + code.message()};
  }
  return AtomicFolder(place, temporary);
}

AtomicFolder::AtomicFolder(AtomicFolder&& other) noexcept
    : target_(std::move(other.target_)), temporary_(std::exchange(other.temporary_, {})) {
  other.temporary_.clear();
}

AtomicFolder::~AtomicFolder() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
}

Status AtomicFolder::commit() {
  sync_path(temporary_, true);
  const fs::path old = target_.parent_path() / temporary_name(target_, ".old-");
  std::error_code code;
  bool replaced = false;
  if (fs::exists(fs::symlink_status(target_, code))) {
    fs::rename(target_, old, code);
    if (code) return Error{target_.string() + ": cannot be replaced: " + code.message()};
    replaced = true;
  }
  fs::rename(temporary_, target_, code);
  if (code) {
    const std::string why = code.message();
    if (replaced) fs::rename(old, target_, code);
    return Error{target_.string() + ": cannot be put into place: " + why};
  }
  temporary_.clear();
  sync_path(target_.parent_path(), false);
  if (replaced) fs::remove_all(old, code);
  return {};
}

Status write_file(const fs::path& path, std::string_view content) {
  const fs::path place = without_slash(path);
  const fs::path temporary = place.parent_path() / temporary_name(place, kPartial);
  std::error_code code;
  {
    std::ofstream file(temporary, std::ios::binary);
    file.write(content.data(), static_cast<std::streamsize>(content.size()));
    file.close();
    if (!file) {
      fs::remove(temporary, code);
      return Error{path.string() + ": cannot be written"};
    }
  }
  sync_path(temporary, false);
  fs::rename(temporary, place, code);
  if (!code) return {};
  const std::string why = code.message();
  fs::remove(temporary, code);
  return Error{path.string() + ": cannot be written: " + why};
}

}  // namespace zenith::tools
