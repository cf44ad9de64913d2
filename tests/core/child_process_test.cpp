// Work in a process of its own: what it sends arrives, and however it ends this process goes on.
#include "granular/core/child_process.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

namespace granular {
namespace {

constexpr ChildProcess::Limits plenty{std::int64_t{1} << 30, 20};

TEST(ChildProcess, SendsMoreThanAPipeHolds) {
  std::vector<double> numbers(1000000);
  for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = static_cast<double>(k);
  ChildProcess child("the reader", plenty, [&](int pipe) { writeToParent(pipe, numbers.data(), 8 * numbers.size()); });
  std::vector<double> got(numbers.size());
  ASSERT_TRUE(child.read(got.data(), 8 * got.size()));
  EXPECT_EQ(got, numbers);
  EXPECT_FALSE(child.read(got.data(), 1));
}

TEST(ChildProcess, ThatCrashesIsReportedWithItsSignal) {
  ChildProcess child("the reader", plenty, [](int) { std::abort(); });
  char byte;
  EXPECT_FALSE(child.read(&byte, 1));
  EXPECT_EQ(child.finish(), "the reader crashed on it (signal 6); the file is malformed");
}

TEST(ChildProcess, ThatTakesTooLongIsStopped) {
  ChildProcess child("the reader", {std::int64_t{1} << 30, 0.2}, [](int) {
    const volatile bool forever = true;
    while (forever) {
    }
  });
  char byte;
  EXPECT_FALSE(child.read(&byte, 1));
  EXPECT_NE(child.finish().find("took more than its time"), std::string::npos);
}

TEST(ChildProcess, ThatEndsTooEarlyIsReported) {
  ChildProcess child("the reader", plenty, [](int pipe) { writeToParent(pipe, "abc", 3); });
  char bytes[4];
  EXPECT_FALSE(child.read(bytes, 4));
  EXPECT_NE(child.finish().find("the reader gave no answer"), std::string::npos);
}

}  // namespace
}  // namespace granular
