#pragma once
// What the core counts since its start, for reports; nothing in the core depends on it.

#include <cstdint>

namespace zenith {

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
  std::uint64_t begun_anew = 0;  // young maps of wrong scale that were given up
};

struct StepCounters {
  std::uint64_t frames = 0;
  std::uint64_t odometry_extrapolated = 0;
  std::uint64_t odometry_rejected = 0;
  std::uint64_t removals_untold = 0;  // of landmarks that peers know
  MapperCounters mapper;
};

}  // namespace zenith
