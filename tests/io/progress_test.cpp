#include "granular/io/progress.h"

#include <gtest/gtest.h>

#include <sstream>

namespace granular {
namespace {

TEST(Progress, ShowsTheTimeLeftAtASteadySpeed) {
  std::ostringstream out;
  double clock = 0;
  Progress progress(out, {false, 0.5, 10, [&] { return clock; }});
  int asked = 0;
  // 100 s of steady work, looked at each second: ten lines at most.
  for (int k = 1; k <= 100; ++k) {
    clock = k;
    progress.report(k / 100.0, [&] { return ++asked, std::string("pouring"); });
  }
  EXPECT_EQ(asked, 10);
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 10);
  EXPECT_NE(text.find(" 10 %  pouring  10 s, 1 min 30 s left"), std::string::npos) << text;
  EXPECT_NE(text.find(" 90 %  pouring  1 min 30 s, 10 s left"), std::string::npos) << text;
  EXPECT_EQ(text.find('\r'), std::string::npos);
}

TEST(Progress, OfAResumedRunCountsFromWhereItWentOn) {
  std::ostringstream out;
  double clock = 1;
  Progress progress(out, {false, 0.5, 10, [&] { return clock; }});
  const auto text = [] { return std::string("standing"); };
  progress.report(0.6, text);
  clock = 21;
  progress.report(0.7, text);
  EXPECT_NE(out.str().find(" 70 %  standing  20 s, 1 min 00 s left"), std::string::npos) << out.str();
}

TEST(Progress, RenewsOneLineOnATerminal) {
  std::ostringstream out;
  double clock = 0;
  Progress progress(out, {true, 0.5, 10, [&] { return clock; }});
  for (const char* word : {"long long text", "short"}) {
    clock += 1;
    progress.report(0.5, [&] { return std::string(word); });
  }
  progress.say("a warning");
  progress.say("another");
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\r'), 2);
  EXPECT_NE(text.find("\na warning\nanother\n"), std::string::npos) << text;
  // The shorter line covers the longer one.
  const std::size_t first = text.find('\r', 1), end = text.find('\n');
  EXPECT_EQ(first, end - first);
}

TEST(Progress, SaysNothingOfTimeLeftBeforeAnythingIsDone) {
  std::ostringstream out;
  double clock = 0;
  Progress progress(out, {false, 0.5, 10, [&] { return clock; }});
  clock = 20;
  progress.report(0, [] { return std::string("starting"); });
  EXPECT_EQ(out.str().find("left"), std::string::npos);
}

TEST(Progress, DurationsReadWell) {
  EXPECT_EQ(formatDuration(2.7), "3 s");
  EXPECT_EQ(formatDuration(59.6), "1 min 00 s");
  EXPECT_EQ(formatDuration(125), "2 min 05 s");
  EXPECT_EQ(formatDuration(3725), "1 h 02 min");
  EXPECT_EQ(formatDuration(1.0 / 0.0), "unknown time");
}

}  // namespace
}  // namespace granular
