#pragma once
// Where the real data lie that tests may read: $ZENITH_DATA, or ../shared/data beside the sources.
// They are no part of the project; a test without them is skipped and says so.

#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

namespace zenith {

inline std::filesystem::path real_data_folder() {
  const char* named = std::getenv("ZENITH_DATA");
  if (named != nullptr && *named != '\0') return named;
  return std::filesystem::path(ZENITH_SOURCE_DIR) / ".." / "shared" / "data";
}

}  // namespace zenith

// Skips the test when the folder `name` of the real data is absent; otherwise goes on.
#define ZENITH_NEED_REAL_DATA(name)                                                          \
  if (!std::filesystem::is_directory(zenith::real_data_folder() / (name)))                   \
  GTEST_SKIP() << "NO REAL DATA: there is no folder " << zenith::real_data_folder() / (name) \
               << ". Set ZENITH_DATA to the folder that holds " << (name) << "."
