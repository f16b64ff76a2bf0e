#include "tools/descriptors/looks.h"

#include <utility>

namespace zenith::tools {

void drop_rare_landmarks(LookSequence& sequence, int min_looks) {
  std::vector<int> count(sequence.places_m.size(), 0);
  for (const Look& look : sequence.looks) ++count[static_cast<std::size_t>(look.landmark)];
  std::vector<int> index(count.size(), -1);
  std::vector<Eigen::Vector3d> places;
  for (std::size_t i = 0; i < count.size(); ++i) {
    if (count[i] < min_looks) continue;
    index[i] = static_cast<int>(places.size());
    places.push_back(sequence.places_m[i]);
  }
  std::erase_if(sequence.looks, [&](Look& look) {
    look.landmark = index[static_cast<std::size_t>(look.landmark)];
    return look.landmark < 0;
  });
  sequence.places_m = std::move(places);
}

}  // namespace zenith::tools
