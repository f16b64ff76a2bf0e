#pragma once
// A folder of few small files, as maps are kept in: what the store needs of a file system, each
// step apart, so that tests can cut the power between any two. Names are those of files right in
// the folder. Errors say the path and what the kernel said. One thread.

#include <string>
#include <utility>
#include <vector>

#include "platform/base/bytes.h"
#include "platform/base/result.h"
#include "platform/linux/unique_fd.h"
#include "platform/storage/folder_lock.h"

namespace zenith::storage {

class Folder {
 public:
  Folder() = default;
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  virtual ~Folder() = default;

  virtual std::string path_of(const std::string& name) const = 0;
  // Before anything is changed in it: from then on it is this program's, as long as this lives.
  virtual LockTry lock(const FolderUser& self) = 0;
  // Also true when it cannot be told: what is there is never overwritten by mistake.
  virtual bool exists(const std::string& name) = 0;
  // At most `most` bytes; a longer file gives one more, so that it shows.
  virtual Result<std::vector<std::uint8_t>> read(const std::string& name, std::size_t most) = 0;

  // A new file, empty, replacing one of this name: write() and sync() go to it until close(). Made
  // by root it becomes the folder owner's, who has to read it.
  virtual Status create(const std::string& name) = 0;
  virtual Status write(Bytes bytes) = 0;
  virtual Status sync() = 0;
  virtual void close() = 0;

  virtual Status rename(const std::string& from, const std::string& to) = 0;
  virtual Status remove(const std::string& name) = 0;
  // Names are on the disk: after create(), rename() and remove().
  virtual Status sync_folder() = 0;
};

// The real one.
class DiskFolder final : public Folder {
 public:
  explicit DiskFolder(std::string path) : path_(std::move(path)) {}

  std::string path_of(const std::string& name) const override { return path_ + "/" + name; }
  LockTry lock(const FolderUser& self) override { return lock_.take(path_, self); }
  bool exists(const std::string& name) override;
  Result<std::vector<std::uint8_t>> read(const std::string& name, std::size_t most) override;
  Status create(const std::string& name) override;
  Status write(Bytes bytes) override;
  Status sync() override;
  void close() override { file_.reset(); }
  Status rename(const std::string& from, const std::string& to) override;
  Status remove(const std::string& name) override;
  Status sync_folder() override;

 private:
  std::string path_;
  FolderLock lock_;
  std::string open_;  // the name of file_
  UniqueFd file_;
};

// What to do about an errno of a file in a folder of maps: "; make room on the disk". Empty for
// most.
std::string folder_advice(int error);
// A file that root made in another user's folder becomes that user's. Else nothing.
void give_to_owner_of(const std::string& folder, int file);

}  // namespace zenith::storage
