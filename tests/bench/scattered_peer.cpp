#include "tests/bench/scattered_peer.h"

#include "tests/bench/rendered_drive.h"

namespace zenith::bench {
namespace {

std::vector<Feature> rendered_looks() {
  std::vector<Feature> looks;
  ExtractorRig extractor(corridor_rooms().robot);
  for (std::size_t i = 20; i < corridor_rooms().frames.size(); i += 5) {
    for (const Feature& f : extractor->extract(corridor_rooms().image(i))) {
      if (f.described) looks.push_back(f);
    }
  }
  return looks;
}

}  // namespace

ScatteredPeer::ScatteredPeer(std::uint64_t seed) : random_(seed), looks_(rendered_looks()) {}

LandmarkRecord ScatteredPeer::record(std::uint32_t index) {
  LandmarkRecord r;
  r.id = index + 1;
  r.revision = 1;
  r.x_m = static_cast<float>(random_.uniform(-11.0, 11.0));
  r.y_m = static_cast<float>(random_.uniform(-11.0, 11.0));
  r.z_m = static_cast<float>(2.55 + 0.03 * random_.normal());
  r.covariance_m2 = {1e-4F, 0.0F, 0.0F, 1e-4F, 0.0F, 4e-4F};
  r.observations = 20;
  for (std::uint8_t k = 0; k < kLooks; ++k) {
    const Feature& f = k == 0 ? look(index) : looks_[(index * 7 + k * 1009u) % looks_.size()];
    r.appearances[k] = {f.compact.values, f.orientation_rad};
  }
  r.appearance_count = kLooks;
  return r;
}

}  // namespace zenith::bench
