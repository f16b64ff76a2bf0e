#pragma once
// Output that appears whole or not at all: written to a temporary sibling, synced to the disk,
// exchanged for what was there when complete. What is dropped on the way (an error, an exception)
// leaves no trace; what a killed process left is swept away, or an older output put back, by the
// next one that writes to the same place (platform/linux/whole_file.h).

#include <filesystem>
#include <string>
#include <string_view>

#include "platform/base/result.h"
#include "platform/linux/unique_fd.h"

namespace zenith::tools {

class AtomicFolder {
 public:
  // How an older output gives way. kTwoSteps is what filesystems get that cannot exchange.
  enum class Replace { kExchange, kTwoSteps };

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

  // Syncs, and puts it into place. Once. With kExchange there is always one of the two there.
  Status commit(Replace how = Replace::kExchange);

 private:
  AtomicFolder(std::filesystem::path target, std::filesystem::path temporary, UniqueFd lock)
      : target_(std::move(target)), temporary_(std::move(temporary)), lock_(std::move(lock)) {}
  Status replace(Replace how);

  std::filesystem::path target_;
  std::filesystem::path temporary_;  // empty once committed
  UniqueFd lock_;                    // of the temporary folder: it is in use
  bool force_ = false;
  std::string marker_;
};

// One file, the same way; an older one is replaced, and anything else but a file stays.
Status write_file(const std::filesystem::path& path, std::string_view content);

}  // namespace zenith::tools
