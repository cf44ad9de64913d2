// Work shared out among threads, or done where it stands: a loop of one thread must not pay for a team.
#pragma once

#include <omp.h>

#include <array>
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

/// What is left of a thread's run of work, by both ends.
class alignas(64) Share {
 public:
  void fill(std::size_t first, std::size_t end) { ends.store(join(first, end), std::memory_order_relaxed); }
  /// The first or last piece that is left, or `none`.
  static constexpr std::size_t none = ~std::size_t{0};
  std::size_t takeFirst() {
    return take([](std::size_t first, std::size_t end) { return std::array{first, first + 1, end}; });
  }
  std::size_t takeLast() {
    return take([](std::size_t first, std::size_t end) { return std::array{end - 1, first, end - 1}; });
  }

 private:
  static std::uint64_t join(std::size_t first, std::size_t end) { return std::uint64_t{end} << 32 | first; }
  /// choose: which piece, and the ends of what is left then.
  template <class Choose>
  std::size_t take(const Choose& choose) {
    std::uint64_t now = ends.load(std::memory_order_relaxed);
    for (;;) {
      const std::size_t first = now & 0xffffffff, end = now >> 32;
      if (first == end) return none;
      const auto [taken, firstLeft, endLeft] = choose(first, end);
      if (ends.compare_exchange_weak(now, join(firstLeft, endLeft), std::memory_order_relaxed)) return taken;
    }
  }
  std::atomic<std::uint64_t> ends = 0;
};

/// Where the run of the t-th of several threads begins.
inline std::size_t beginOfRun(std::size_t t, std::size_t threads, std::size_t count) { return t * count / threads; }

/// Calls work(k, own) for k = 0 ... count - 1, below 2^32. If worthwhile each thread has a run of them, the same one
/// from call to call, so that what they read and write stays near it, and does it in order (own: true); whoever is done
/// helps the others from the ends of their runs (own: false). Otherwise one thread does all in order. Apart from those
/// of one thread in order, the calls must not depend on each other.
template <class Work>
void shareOut(std::size_t count, bool worthwhile, Work&& work) {
  const auto threads = static_cast<std::size_t>(omp_get_max_threads());
  if (!worthwhile || threads == 1) {
    for (std::size_t k = 0; k < count; ++k) work(k, true);
    return;
  }
  auto& shares = ownOfThread<std::vector<Share>>();
  if (shares.size() != threads) shares = std::vector<Share>(threads);
  for (std::size_t t = 0; t < threads; ++t)
    shares[t].fill(beginOfRun(t, threads, count), beginOfRun(t + 1, threads, count));
#pragma omp parallel
  {
    const auto own = static_cast<std::size_t>(omp_get_thread_num());
    for (std::size_t k; (k = shares[own].takeFirst()) != Share::none;) work(k, true);
    for (std::size_t t = 1; t < threads; ++t) {
      Share& other = shares[(own + t) % threads];
      for (std::size_t k; (k = other.takeLast()) != Share::none;) work(k, false);
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
