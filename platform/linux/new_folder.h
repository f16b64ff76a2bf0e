#pragma once
// A folder that this program has made, and new files in it, by descriptors: whatever somebody does
// to its path, files are made in this folder and nowhere else, and no link is followed. For threads
// without deadlines; any number of them at a time.

#include <filesystem>
#include <string>
#include <string_view>

#include "platform/base/result.h"
#include "platform/linux/unique_fd.h"

namespace zenith {

class NewFolder {
 public:
  // Something that is there already is an error, an empty folder too. Parents are made.
  static Result<NewFolder> make(const std::filesystem::path& path);

  // Names are those of one step, made by this program: digits, letters, dots.
  Result<NewFolder> make_folder(const std::string& name) const;
  // For writing. One that is there already is an error.
  Result<UniqueFd> create_file(const std::string& name) const;
  // A whole file of this content.
  Status write_file(const std::string& name, std::string_view content) const;
  void remove_file(const std::string& name) const;

  // For messages, and for what reads.
  const std::filesystem::path& path() const { return path_; }

 private:
  NewFolder(UniqueFd fd, std::filesystem::path path) : fd_(std::move(fd)), path_(std::move(path)) {}
  static Result<NewFolder> make_at(int parent, const std::string& name,
                                   const std::filesystem::path& path);

  UniqueFd fd_;
  std::filesystem::path path_;
};

}  // namespace zenith
