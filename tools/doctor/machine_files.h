#pragma once
// Small files of the kernel, below a root that tests replace: "/sys/..." is read at root +
// "/sys/...".

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace zenith::tools {

class MachineFiles {
 public:
  explicit MachineFiles(std::filesystem::path root = "/") : root_(std::move(root)) {}

  // `path` begins with a slash.
  std::filesystem::path at(const std::string& path) const { return root_ / path.substr(1); }
  bool exists(const std::string& path) const;
  // Up to 64 kB without trailing white space; nothing when it cannot be read.
  std::optional<std::string> read(const std::string& path) const;
  std::optional<long long> number(const std::string& path) const;
  // Names in a folder, sorted; empty when there is none.
  std::vector<std::string> list(const std::string& folder) const;

 private:
  std::filesystem::path root_;
};

// A program that has a device open.
struct DeviceUser {
  int pid = 0;
  std::string name;  // of the program, 15 bytes at most
};

// Who has the file `device` open, by /proc/*/fd; symbolic links in `device` are followed. Other
// users' programs are seen by root alone. Not this program itself.
std::vector<DeviceUser> users_of(const MachineFiles& files, const std::string& device);

}  // namespace zenith::tools
