#pragma once

#include <string>

namespace zenith::tools {

// As printf, at most 255 bytes.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

}  // namespace zenith::tools
