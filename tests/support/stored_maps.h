#pragma once
// Maps as they are stored, with all numbers used.

#include "platform/base/random.h"
#include "platform/storage/map_file.h"

namespace zenith::storage {

// `count` landmarks over a building of 40 m, with 1 to 7 looks each.
inline StoredMap random_map(std::size_t count, Random& random) {
  StoredMap map;
  map.head.map = 0x0123456789ABCDEFu;
  map.head.saved_s = 1'790'000'000;
  map.head.robot.assign("ada");
  map.head.camera_height_m = 0.3;
  map.head.rectified_fov_deg = 120.0;
  for (std::size_t i = 0; i < count; ++i) {
    LandmarkRecord r;
    r.id = static_cast<std::uint32_t>(i + 1);
    r.revision = 1;
    r.x_m = static_cast<float>(random.uniform() * 40.0 - 20.0);
    r.y_m = static_cast<float>(random.uniform() * 40.0 - 20.0);
    r.z_m = static_cast<float>(2.0 + random.uniform());
    r.covariance_m2 = {1e-4F, 2e-5F, 0.0F, 2e-4F, -1e-5F, 4e-4F};
    r.observations = static_cast<std::uint16_t>(1 + random.uniform() * 200.0);
    r.appearance_count = static_cast<std::uint8_t>(1 + random.uniform() * 6.9);
    for (std::size_t k = 0; k < r.appearance_count; ++k) {
      for (auto& v : r.appearances[k].descriptor) {
        v = static_cast<std::int8_t>(random.uniform() * 200.0 - 100.0);
      }
      r.appearances[k].direction_rad = static_cast<float>(random.uniform() * 6.0 - 3.0);
    }
    map.landmarks.push_back(r);
  }
  return map;
}

}  // namespace zenith::storage
