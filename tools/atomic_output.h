#pragma once
// Output that appears whole or not at all: written to a temporary sibling, synced to the disk,
// renamed when complete. What is dropped on the way (an error, an exception) leaves no trace; what
// a killed process left is swept away by the next one that writes to the same place.

#include <filesystem>
#include <string>
#include <string_view>

#include "platform/base/result.h"

namespace zenith::tools {

class AtomicFolder {
 public:
  // `target` must not exist, or be an empty folder. With `force` an older output is replaced, at
  // commit(); as a guard against accidents only a folder that holds the file `marker` is.
  static Result<AtomicFolder> create(const std::filesystem::path& target, bool force,
                                     std::string_view marker);

  AtomicFolder(AtomicFolder&& other) noexcept;
  AtomicFolder& operator=(AtomicFolder&&) = delete;
  ~AtomicFolder();

  // Where to write until commit().
  const std::filesystem::path& path() const { return temporary_; }
  const std::filesystem::path& target() const { return target_; }

  // Syncs and renames. Once.
  Status commit();

 private:
  AtomicFolder(std::filesystem::path target, std::filesystem::path temporary)
      : target_(std::move(target)), temporary_(std::move(temporary)) {}

  std::filesystem::path target_;
  std::filesystem::path temporary_;  // empty once committed
};

// One file, the same way; an older one is replaced.
Status write_file(const std::filesystem::path& path, std::string_view content);

}  // namespace zenith::tools
