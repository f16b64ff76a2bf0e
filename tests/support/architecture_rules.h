#pragma once
// The include rules of the house ("Who may include whom") and what the core must not call, as a
// check of source text. Paths are relative to the root of the sources, such as "slam/slam.h".

#include <string>
#include <string_view>
#include <vector>

namespace zenith {

struct Violation {
  std::string file;
  int line = 0;  // from 1
  std::string rule;

  // "slam/x.h:12: rule", as compilers write it.
  std::string text() const;
};

// The text without comments and without the contents of string and character literals; lines keep
// their numbers. Paths in #include "..." stay.
std::string strip_comments_and_literals(std::string_view source);

// All violations in one file.
std::vector<Violation> check_architecture(const std::string& file, std::string_view source);

}  // namespace zenith
