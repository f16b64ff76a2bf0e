#include "drivers/leds/class_leds.h"

#include <dirent.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>
#include <vector>

#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

// Attributes are written whole, in one call.
bool write_text(int fd, std::string_view text) {
  return ::pwrite(fd, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
}

bool write_attribute(const std::string& path, std::string_view text) {
  const UniqueFd fd(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  return fd.is_open() && write_text(fd.get(), text);
}

// Without the ending line feed; empty when it cannot be read. A list of triggers may be longer than
// a page of the kernel's.
std::string read_attribute(const std::string& path) {
  const UniqueFd fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  std::string text;
  std::array<char, 4096> part;
  ssize_t count = 0;
  while (fd.is_open() && (count = ::read(fd.get(), part.data(), part.size())) > 0) {
    text.append(part.data(), static_cast<std::size_t>(count));
  }
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

// "none [mmc0] timer" -> "mmc0"; empty for none.
std::string active_trigger(const std::string& list) {
  const std::size_t begin = list.find('[');
  const std::size_t end = list.find(']', begin);
  if (begin == std::string::npos || end == std::string::npos) return {};
  const std::string name = list.substr(begin + 1, end - begin - 1);
  return name == "none" ? std::string() : name;
}

std::string names_in(const std::string& folder) {
  std::vector<std::string> names;
  if (DIR* dir = ::opendir(folder.c_str())) {
    while (const dirent* entry = ::readdir(dir)) {
      if (entry->d_name[0] != '.') names.emplace_back(entry->d_name);
    }
    ::closedir(dir);
  }
  std::sort(names.begin(), names.end());
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

Error cannot_open(const std::string& path, const std::string& folder, int error) {
  std::string message = "LED file " + path + ": " + errno_text(error);
  if (error == ENOENT) {
    message += "; LEDs of this kernel: " + names_in(folder) + "; name one of them";
  } else if (error == EACCES || error == EPERM || error == EROFS) {
    message +=
        "; give the service's group write access to brightness and trigger (udev rule), and "
        "the unit the path (ReadWritePaths=)";
  }
  return {message};
}

}  // namespace

Status ClassLed::open() {
  close();
  brightness_.reset(::open(file("brightness").c_str(), O_WRONLY | O_CLOEXEC));
  if (!brightness_.is_open()) return cannot_open(file("brightness"), class_folder_, errno);
  full_ = read_attribute(file("max_brightness"));
  if (full_.empty()) full_ = "1";
  trigger_ = active_trigger(read_attribute(file("trigger")));
  if (!trigger_.empty() && !write_attribute(file("trigger"), "none")) {
    const int error = errno;
    trigger_.clear();
    brightness_.reset();
    return cannot_open(file("trigger"), class_folder_, error);
  }
  return set(false);
}

void ClassLed::close() {
  if (!brightness_.is_open()) return;
  write_text(brightness_.get(), "0");
  brightness_.reset();
  if (!trigger_.empty()) write_attribute(file("trigger"), trigger_);
  trigger_.clear();
}

Status ClassLed::set(bool lit) {
  if (!brightness_.is_open()) return {};
  if (write_text(brightness_.get(), lit ? full_ : "0")) return {};
  return cannot_open(file("brightness"), class_folder_, errno);
}

}  // namespace zenith
