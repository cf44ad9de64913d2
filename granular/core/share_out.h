// Work shared out among threads, or done where it stands: a loop of one thread must not pay for a team.
#pragma once

#include <omp.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace granular {

/// A thread's own: large, and kept from call to call.
template <class Thing>
Thing& ownOfThread() {
  thread_local Thing thing{};
  return thing;
}

/// What is left of a thread's share.
struct alignas(64) Share {
  std::atomic<std::size_t> next = 0;
  std::size_t end = 0;
};

/// Calls work(k) for k = 0 ... count - 1, in no certain order if worthwhile and there are several threads. The calls
/// must not depend on each other. Each thread has a run of them, the same one from call to call, so that what they read
/// and write stays near it; whoever is done helps the others.
template <class Work>
void shareOut(std::size_t count, bool worthwhile, Work&& work) {
  const auto threads = static_cast<std::size_t>(omp_get_max_threads());
  if (!worthwhile || threads == 1) {
    for (std::size_t k = 0; k < count; ++k) work(k);
    return;
  }
  auto& shares = ownOfThread<std::vector<Share>>();
  if (shares.size() != threads) shares = std::vector<Share>(threads);
  for (std::size_t t = 0; t < threads; ++t) {
    shares[t].next.store(t * count / threads, std::memory_order_relaxed);
    shares[t].end = (t + 1) * count / threads;
  }
#pragma omp parallel
  {
    const auto own = static_cast<std::size_t>(omp_get_thread_num());
    for (std::size_t t = 0; t < threads; ++t) {
      Share& share = shares[(own + t) % threads];
      for (;;) {
        const std::size_t k = share.next.fetch_add(1, std::memory_order_relaxed);
        if (k >= share.end) break;
        work(k);
      }
    }
  }
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

}  // namespace granular
