#pragma once
// How often this program took memory from the heap with new.

#include <cstdint>

namespace zenith {

std::uint64_t allocation_count();         // in all threads
std::uint64_t thread_allocation_count();  // in the calling thread

}  // namespace zenith
