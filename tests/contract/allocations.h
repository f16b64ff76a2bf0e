#pragma once
// How often this program took memory from the heap with new, in all threads.

#include <cstdint>

namespace zenith {

std::uint64_t allocation_count();

}  // namespace zenith
