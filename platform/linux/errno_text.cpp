#include "platform/linux/errno_text.h"

#include <cstring>

namespace zenith {

std::string errno_text(int error) {
  const char* name = strerrorname_np(error);
  const char* description = strerrordesc_np(error);
  if (name == nullptr || description == nullptr) return "error " + std::to_string(error);
  return std::string(description) + " (" + name + ")";
}

}  // namespace zenith
