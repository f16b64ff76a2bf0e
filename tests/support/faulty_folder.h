#pragma once
// A folder whose power is cut, or whose disk is full or read-only: what a file system may leave
// when nothing was synced. After a cut, changes of names that were not synced are there up to some
// point and lost behind it; data that were not synced are lost, cut short, zeros or noise.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "platform/base/random.h"
#include "platform/storage/folder.h"

namespace zenith::storage {

class FaultyFolder final : public Folder {
 public:
  explicit FaultyFolder(std::uint64_t seed) : random_(seed, 1) {}

  // The power goes before the next change but `changes`; everything fails until power_on().
  void cut_after(int changes) { left_ = changes; }
  bool is_cut() const { return left_ == 0; }
  int changes() const { return changes_; }
  void power_on();

  void set_full(bool full) { full_ = full; }
  void set_read_only(bool read_only) { read_only_ = read_only; }
  // Files are written and synced, the folder is not: its names may be lost at the next cut.
  void fail_folder_sync(bool fail) { folder_sync_fails_ = fail; }
  // As a program with other ideas would.
  void put(const std::string& name, std::vector<std::uint8_t> bytes);
  std::vector<std::string> names() const;

  // Another program has the folder; nullopt: none has.
  void set_user(std::optional<FolderUser> user) { user_ = std::move(user); }

  std::string path_of(const std::string& name) const override { return "disk/" + name; }
  LockTry lock(const FolderUser& self) override;
  bool exists(const std::string& name) override { return names_.count(name) != 0; }
  Result<std::vector<std::uint8_t>> read(const std::string& name, std::size_t most) override;
  Status create(const std::string& name) override;
  Status write(Bytes bytes) override;
  Status sync() override;
  void close() override { open_ = -1; }
  Status rename(const std::string& from, const std::string& to) override;
  Status remove(const std::string& name) override;
  Status sync_folder() override;

 private:
  struct File {
    std::vector<std::uint8_t> now;
    std::vector<std::uint8_t> on_disk;
    bool synced = false;
  };
  using Names = std::map<std::string, int>;

  Status change(const char* what);
  void note_names() { history_.push_back(names_); }

  Random random_;
  int left_ = -1;  // changes until the cut; negative: none comes
  int changes_ = 0;
  bool full_ = false;
  bool read_only_ = false;
  bool folder_sync_fails_ = false;
  std::optional<FolderUser> user_;
  bool locked_ = false;  // once
  std::map<int, File> files_;
  int next_ = 0;
  int open_ = -1;
  Names names_;
  std::vector<Names> history_ = {{}};  // what names may be after a cut; the first is on the disk
};

}  // namespace zenith::storage
