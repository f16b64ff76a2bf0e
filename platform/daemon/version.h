#pragma once

namespace zenith {

inline constexpr const char* kVersion = ZENITH_VERSION;  // from CMakeLists.txt

}  // namespace zenith
