#include "tools/doctor/machine_files.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>

#include "platform/linux/input_file.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMost = 65536;

int pid_of(const std::string& name) {
  int pid = 0;
  const char* end = name.data() + name.size();
  const auto [stop, status] = std::from_chars(name.data(), end, pid);
  return status == std::errc() && stop == end ? pid : 0;
}

}  // namespace

bool MachineFiles::exists(const std::string& path) const {
  std::error_code code;
  return fs::exists(at(path), code);
}

std::optional<std::string> MachineFiles::read(const std::string& path) const {
  const auto file = open_input(at(path).string());
  if (!file) return std::nullopt;
  std::string text(kMost, '\0');
  const std::ptrdiff_t count = read_fully(file->fd.get(), text.data(), text.size());
  if (count < 0) return std::nullopt;
  text.resize(static_cast<std::size_t>(count));
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ' || text.back() == '\0')) {
    text.pop_back();
  }
  return text;
}

std::optional<long long> MachineFiles::number(const std::string& path) const {
  const auto text = read(path);
  if (!text) return std::nullopt;
  long long value = 0;
  const char* begin = text->data();
  const char* end = begin + text->size();
  const bool hexadecimal = text->rfind("0x", 0) == 0;
  const auto [stop, status] =
      std::from_chars(hexadecimal ? begin + 2 : begin, end, value, hexadecimal ? 16 : 10);
  if (text->empty() || status != std::errc() || stop != end) return std::nullopt;
  return value;
}

std::vector<std::string> MachineFiles::list(const std::string& folder) const {
  std::vector<std::string> names;
  std::error_code code;
  fs::directory_iterator entry(at(folder), code);
  for (; !code && entry != fs::directory_iterator(); entry.increment(code)) {
    names.push_back(entry->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<DeviceUser> users_of(const MachineFiles& files, const std::string& device) {
  std::vector<DeviceUser> users;
  std::error_code code;
  const fs::path real = fs::canonical(files.at(device), code);
  const std::string wanted = code ? device : real.string();
  for (const std::string& name : files.list("/proc")) {
    const int pid = pid_of(name);
    if (pid == 0 || pid == ::getpid()) continue;
    const std::string folder = "/proc/" + name + "/fd";
    for (const std::string& fd : files.list(folder)) {
      const fs::path target = fs::read_symlink(files.at(folder + "/" + fd), code);
      if (code || (target != wanted && target != device)) continue;
      users.push_back({pid, files.read("/proc/" + name + "/comm").value_or("?")});
      break;
    }
  }
  return users;
}

}  // namespace zenith::tools
