// Work shared out among threads, or done where it stands: a loop of one thread must not pay for a team.
#pragma once

#include <omp.h>

#include <cstddef>
#include <cstdint>

namespace granular {

/// Calls work(k) for k = 0 ... count - 1, in no certain order if worthwhile and there are several threads. The calls
/// must not depend on each other.
template <class Work>
void shareOut(std::size_t count, bool worthwhile, Work&& work) {
  if (!worthwhile || omp_get_max_threads() == 1) {
    for (std::size_t k = 0; k < count; ++k) work(k);
    return;
  }
  const auto n = static_cast<std::int64_t>(count);
#pragma omp parallel for schedule(dynamic, 1)
  for (std::int64_t k = 0; k < n; ++k) work(static_cast<std::size_t>(k));
}

/// The same for many small pieces of equal size: each thread gets one run of them.
template <class Work>
void shareOutEvenly(std::size_t count, bool worthwhile, Work&& work) {
  if (!worthwhile || omp_get_max_threads() == 1) {
    for (std::size_t k = 0; k < count; ++k) work(k);
    return;
  }
  const auto n = static_cast<std::int64_t>(count);
#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < n; ++k) work(static_cast<std::size_t>(k));
}

/// A thread's own: large, and kept from call to call.
template <class Thing>
Thing& ownOfThread() {
  thread_local Thing thing{};
  return thing;
}

}  // namespace granular
