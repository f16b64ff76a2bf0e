#pragma once

#include <string>

namespace zenith {

// "Permission denied (EACCES)", in English whatever the locale. Any thread.
std::string errno_text(int error);

}  // namespace zenith
