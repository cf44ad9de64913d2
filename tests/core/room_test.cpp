#include "granular/core/room.h"

#include <gtest/gtest.h>

#include <numeric>

namespace granular {
namespace {

TEST(Room, VectorsThatGrowOneByOneHaveAtMostASixteenthMoreThanTheyUse) {
  std::vector<int> items;
  std::size_t moves = 0;
  for (std::size_t count = 1; count <= 100000; ++count) {
    const int* before = items.data();
    resizeClosely(items, count);
    moves += items.data() != before;
    ASSERT_EQ(items.size(), count);
    ASSERT_LE(items.capacity(), count + count / 16);
  }
  // Geometric: ln(100000 / 16) / ln(17 / 16) = 144 times beyond the first ones, and some for the whole numbers.
  EXPECT_LT(moves, 200u);
}

TEST(Room, TrimmedVectorsKeepTheirItemsAndGiveBackMuchThatIsLeftOver) {
  std::vector<int> items(1000);
  std::iota(items.begin(), items.end(), 0);
  items.resize(500);
  std::vector<int> expected = items;
  trim(items);
  EXPECT_EQ(items, expected);
  EXPECT_EQ(items.capacity(), 500u);
  items.reserve(600);
  const int* before = items.data();
  trim(items);  // a little may stay: whoever comes next need not ask for it
  EXPECT_EQ(items.data(), before);
}

TEST(Room, DiscardedVectorsHaveNone) {
  std::vector<int> items(1000);
  discard(items);
  EXPECT_EQ(items.capacity(), 0u);
}

}  // namespace
}  // namespace granular
