#pragma once
// What the core counts since its start, for reports; nothing in the core depends on it.

#include <array>
#include <cstdint>
#include <string_view>

namespace zenith {

// What was found broken after a phase of the step, and repaired: numbers that are not finite or lie
// beyond slam/bounds.h. All zero as long as input and arithmetic are sound.
struct RepairCounters {
  std::uint64_t travels_refused = 0;      // of the wheels: counted as none
  std::uint64_t particles_moved = 0;      // a pose: put at the heaviest particle, without weight
  std::uint64_t weights_zeroed = 0;       // of one particle
  std::uint64_t weights_equalised = 0;    // none was left: all alike
  std::uint64_t poses_reset = 0;          // of all particles: scattered around the last mean
  std::uint64_t corrections_dropped = 0;  // a frame's pose correction: the matches steer no more
  std::uint64_t calibrations_reset = 0;   // of the camera: learned from the start
  std::uint64_t landmarks_dropped = 0;    // rows or place
  std::uint64_t maps_reset = 0;           // with which the poses broke again and again

  std::uint64_t total() const;
};

struct RepairKind {
  std::string_view name;
  std::uint64_t RepairCounters::*count;
};
inline constexpr std::array<RepairKind, 9> kRepairKinds = {{
    {"travels_refused", &RepairCounters::travels_refused},
    {"particles_moved", &RepairCounters::particles_moved},
    {"weights_zeroed", &RepairCounters::weights_zeroed},
    {"weights_equalised", &RepairCounters::weights_equalised},
    {"poses_reset", &RepairCounters::poses_reset},
    {"corrections_dropped", &RepairCounters::corrections_dropped},
    {"calibrations_reset", &RepairCounters::calibrations_reset},
    {"landmarks_dropped", &RepairCounters::landmarks_dropped},
    {"maps_reset", &RepairCounters::maps_reset},
}};
static_assert(sizeof(RepairCounters) == kRepairKinds.size() * sizeof(std::uint64_t));

inline std::uint64_t RepairCounters::total() const {
  std::uint64_t sum = 0;
  for (const RepairKind& kind : kRepairKinds) sum += this->*kind.count;
  return sum;
}

struct MapperCounters {
  std::uint64_t resamplings = 0;
  std::uint64_t landmarks_created = 0;
  std::uint64_t landmarks_promoted = 0;
  std::uint64_t landmarks_pruned = 0;
  std::uint64_t landmarks_evicted = 0;
  std::uint64_t landmarks_rejected_full = 0;
  std::uint64_t appearances_rejected_full = 0;
  std::uint64_t candidates_rejected_full = 0;
  std::uint64_t loops_closed = 0;
  std::uint64_t slips = 0;
  std::uint64_t poses_recovered = 0;  // by the search around the pose, after a slip or a push
  std::uint64_t frames_held = 0;      // that do not fit where the wheels lead: not used
  std::uint64_t times_lost = 0;       // held for too long
  std::uint64_t relocalised = 0;      // found again in the own map
  std::uint64_t frames_blind = 0;     // used ones that showed too little of the map: by the wheels
  std::uint64_t begun_anew = 0;  // young maps of wrong scale that were given up, and maps_reset
  RepairCounters repairs;
};

struct StepCounters {
  std::uint64_t frames = 0;           // used or not, refused ones left out
  std::uint64_t frames_refused = 0;   // of another size than the lens, or stamps that do not rise
  std::uint64_t frames_repeated = 0;  // the last picture though the wheels moved: not used
  std::uint64_t odometry_extrapolated = 0;
  std::uint64_t odometry_rejected = 0;   // samples beyond bounds, or not newer than the last
  std::uint64_t odometry_jumps = 0;      // totals that jumped further than a wheel turns
  std::uint64_t records_refused = 0;     // peers' that are not plausible, or find no room
  std::uint64_t calls_refused = 0;       // of a peer that cannot be, or with no usable alignment
  std::uint64_t parameters_limited = 0;  // to their range
  std::uint64_t removals_untold = 0;     // of landmarks that peers know
  MapperCounters mapper;
};

}  // namespace zenith
