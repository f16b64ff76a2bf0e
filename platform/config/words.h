#pragma once

#include <string>
#include <vector>

namespace zenith {

// Known words near `word`, best first, at most three; none when nothing is near.
std::vector<std::string> nearest_words(const std::string& word,
                                       const std::vector<std::string>& known);

}  // namespace zenith
