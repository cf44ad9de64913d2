// How often a benchmark asks for memory, and how much it holds: malloc and its kin counted in this program alone.
#pragma once

#include <cstddef>
#include <cstdint>

namespace granular::benchmarks {

/// Calls of malloc, calloc, realloc and the aligned ones so far, operator new included, by whatever library.
std::uint64_t allocationCount();

/// Bytes on the heap now.
std::size_t heapBytes();

}  // namespace granular::benchmarks
