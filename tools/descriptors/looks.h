#pragma once
// Looks of the same landmarks from different frames: what a descriptor must recognise. Which look
// belongs to which landmark is decided by geometry alone, never by how it looks.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "platform/base/result.h"
#include "slam/geometry.h"
#include "slam/image/patch.h"

namespace zenith::tools {

struct Look {
  int landmark = -1;  // index into LookSequence::places_m
  int robot = 0;
  int frame = 0;
  Pose2 T_world_robot;         // where it was taken from
  float direction_rad = 0.0F;  // of the patch, in the world: the same in all looks, ideally
  Patch patch;
};

// `places_m`: the landmarks, in one frame for all robots of the sequence.
struct LookSequence {
  std::string name;
  int robots = 1;
  bool synthetic = false;  // robot 0 took the photographs, robot 1 looks again at distorted copies
  std::vector<Look> looks;
  std::vector<Eigen::Vector3d> places_m;
};

// A simulated world: true poses, and corners carried along their true rays to the building's
// surfaces. Sightings of one surface within 2 pixels are one landmark. `ceilings`: what is seen on
// horizontal surfaces alone, no walls.
Result<LookSequence> simulated_looks(const std::string& world, std::uint64_t seed,
                                     double duration_s, bool ceilings);

// A recording: its own map, made by the Mapper. A corner is a look of the promoted landmark that is
// predicted within 2 pixels of it.
Result<LookSequence> mapped_looks(const std::filesystem::path& recording, std::uint64_t seed);

// Photographs of ceilings, each looked at again after a turn by any angle, a shift of less than a
// pixel, and a change of gain, offset and noise. Corners are found anew.
Result<LookSequence> photo_looks(const std::filesystem::path& folder, std::uint64_t seed);

// Leaves landmarks of at least so many looks.
void drop_rare_landmarks(LookSequence& sequence, int min_looks);

}  // namespace zenith::tools
