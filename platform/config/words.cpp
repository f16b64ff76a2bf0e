#include "platform/config/words.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace zenith {
namespace {

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      const std::size_t change = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, change});
      diagonal = above;
    }
  }
  return row[b.size()];
}

}  // namespace

std::vector<std::string> nearest_words(const std::string& word,
                                       const std::vector<std::string>& known) {
  constexpr std::size_t kLongest = 64;  // no known word is near to longer ones
  std::vector<std::pair<std::size_t, std::string>> ranked;
  if (word.size() > kLongest) return {};
  for (const std::string& candidate : known) {
    const bool contains = word.size() >= 3 && candidate.find(word) != std::string::npos;
    const std::size_t distance = contains ? 1 : edit_distance(word, candidate);
    if (distance <= std::max<std::size_t>(2, word.size() / 3)) {
      ranked.emplace_back(distance, candidate);
    }
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::string> nearest;
  for (const auto& [distance, candidate] : ranked) {
    if (nearest.size() < 3) nearest.push_back(candidate);
  }
  return nearest;
}

}  // namespace zenith
