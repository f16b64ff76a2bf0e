#include "tests/support/faulty_folder.h"

namespace zenith::storage {

Status FaultyFolder::change(const char* what) {
  if (left_ == 0) return Error{std::string(what) + ": no power"};
  if (read_only_) return Error{std::string(what) + ": read-only (EROFS)"};
  if (left_ > 0) --left_;
  ++changes_;
  return {};
}

void FaultyFolder::power_on() {
  left_ = -1;
  open_ = -1;
  const auto pick = [this](std::size_t count) {
    return static_cast<std::size_t>(random_.uniform() * static_cast<double>(count));
  };
  names_ = history_[pick(history_.size())];
  history_ = {names_};
  for (auto& [number, file] : files_) {
    if (!file.synced) {
      switch (pick(5)) {
        case 0:
          file.now = file.on_disk;
          break;
        case 1:
          file.now.resize(pick(file.now.size() + 1));
          break;
        case 2:
          std::fill(file.now.begin(), file.now.end(), std::uint8_t{0});
          break;
        case 3:
          for (std::uint8_t& byte : file.now) {
            if (pick(50) == 0) byte = static_cast<std::uint8_t>(pick(256));
          }
          break;
        default:
          break;  // all of it came to the disk
      }
    }
    file.on_disk = file.now;
    file.synced = true;
  }
}

LockTry FaultyFolder::lock(const FolderUser& /*self*/) {
  if (user_) return {LockTry::State::kOthers, "disk is in use by " + user_text(*user_)};
  if (read_only_ && !locked_) {
    return {LockTry::State::kUnknown, "cannot lock disk/lock: read-only (EROFS)"};
  }
  locked_ = true;
  return {LockTry::State::kOurs, ""};
}

void FaultyFolder::put(const std::string& name, std::vector<std::uint8_t> bytes) {
  files_[next_] = {bytes, bytes, true};
  names_[name] = next_++;
  history_ = {names_};
}

std::vector<std::string> FaultyFolder::names() const {
  std::vector<std::string> names;
  for (const auto& [name, file] : names_) names.push_back(name);
  return names;
}

Result<std::vector<std::uint8_t>> FaultyFolder::read(const std::string& name, std::size_t most) {
  const auto found = names_.find(name);
  if (found == names_.end()) return Error{"no such file"};
  std::vector<std::uint8_t> bytes = files_[found->second].now;
  if (bytes.size() > most) bytes.resize(most + 1);
  return bytes;
}

Status FaultyFolder::create(const std::string& name) {
  if (const Status done = change("create"); !done) return done;
  files_[next_] = {};
  names_[name] = open_ = next_++;
  note_names();
  return {};
}

Status FaultyFolder::write(Bytes bytes) {
  if (const Status done = change("write"); !done) return done;
  File& file = files_[open_];
  file.synced = false;
  const std::size_t fits = full_ ? bytes.size() / 2 : bytes.size();
  file.now.insert(file.now.end(), bytes.begin(), bytes.begin() + static_cast<long>(fits));
  if (full_) return Error{"write: no space left (ENOSPC)"};
  return {};
}

Status FaultyFolder::sync() {
  if (const Status done = change("sync"); !done) return done;
  File& file = files_[open_];
  file.on_disk = file.now;
  file.synced = true;
  return {};
}

Status FaultyFolder::rename(const std::string& from, const std::string& to) {
  if (const Status done = change("rename"); !done) return done;
  const auto found = names_.find(from);
  if (found == names_.end()) return Error{"rename: no such file"};
  const int file = found->second;
  names_.erase(found);
  names_[to] = file;
  note_names();
  return {};
}

Status FaultyFolder::remove(const std::string& name) {
  if (const Status done = change("remove"); !done) return done;
  names_.erase(name);
  note_names();
  return {};
}

Status FaultyFolder::sync_folder() {
  if (const Status done = change("sync the folder"); !done) return done;
  if (folder_sync_fails_) return Error{"sync the folder: input/output error (EIO)"};
  history_ = {names_};
  return {};
}

}  // namespace zenith::storage
