#include "granular/core/share_out.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <vector>

namespace granular {
namespace {

/// How often each piece of work was done in `calls` calls; the first pieces take the longest.
std::vector<int> countCalls(int threads, std::size_t count, bool worthwhile, int calls) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  std::vector<int> done(count, 0);
  std::vector<double> made(count, 0);
  for (int call = 0; call < calls; ++call) {
    shareOut(count, worthwhile, [&](std::size_t k, bool) {
      const std::size_t effort = k < count / 4 ? 2000 : 10;
      for (std::size_t n = 0; n < effort; ++n) made[k] += std::sqrt(static_cast<double>(n + k));
      ++done[k];
    });
  }
  omp_set_num_threads(before);
  return done;
}

TEST(ShareOut, DoesEachPieceOnceWhateverTheThreads) {
  constexpr int calls = 20;
  for (const int threads : {1, 2, 3, 4, 7}) {
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{3}, std::size_t{100}}) {
      for (const bool worthwhile : {false, true}) {
        EXPECT_EQ(countCalls(threads, count, worthwhile, calls), std::vector<int>(count, calls))
            << threads << " threads, " << count << " pieces";
      }
    }
  }
}

TEST(ShareOut, HelpsAThreadWhoseShareTakesLonger) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(2);
  // The first piece of the second share ends only when its other pieces are done: by the other thread.
  constexpr std::size_t count = 20, blocked = count / 2;
  std::atomic<std::size_t> others = 0;
  std::atomic<bool> helped = true;
  shareOut(count, true, [&](std::size_t k, bool) {
    if (k != blocked) {
      ++others;
      return;
    }
    if (omp_get_num_threads() < 2) return;  // a machine that gives one thread alone
    const double began = omp_get_wtime();
    while (others < count - 1 && helped) helped = omp_get_wtime() - began < 60;
  });
  omp_set_num_threads(before);
  EXPECT_TRUE(helped);
  EXPECT_EQ(others, count - 1);
}

TEST(ShareOut, WhoeverOwnsARunGoesInOrderAndHelpersTakeItsEnd) {
  const int before = omp_get_max_threads();
  constexpr std::size_t count = 200;
  for (const std::size_t threads : {1, 2, 3}) {
    omp_set_num_threads(static_cast<int>(threads));
    for (int call = 0; call < 50; ++call) {
      std::vector<int> isOwn(count, -1), thread(count, -1);
      std::vector<std::size_t> place(count);
      std::atomic<std::size_t> clock = 0;
      shareOut(count, true, [&](std::size_t k, bool own) {
        isOwn[k] = own;
        thread[k] = omp_get_thread_num();
        place[k] = clock++;
        volatile double sum = 0;
        for (std::size_t n = 0; n < (k < count / 2 ? 400 : 20); ++n) sum = sum + std::sqrt(static_cast<double>(n));
      });
      for (std::size_t t = 0; t < threads; ++t) {
        for (std::size_t k = beginOfRun(t, threads, count) + 1; k < beginOfRun(t + 1, threads, count); ++k) {
          ASSERT_LE(isOwn[k], isOwn[k - 1]) << "a helper's piece before one of the owner's";
          if (isOwn[k] != 1) continue;
          ASSERT_LT(place[k - 1], place[k]);
          ASSERT_EQ(thread[k], thread[k - 1]);
        }
      }
    }
  }
  omp_set_num_threads(before);
}

}  // namespace
}  // namespace granular
