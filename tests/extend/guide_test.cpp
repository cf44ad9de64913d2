// The user guide's code is code that is compiled.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
const fs::path root = GRANULAR_SOURCE_DIR;

std::string withoutMargin(const std::string& line) {
  const std::size_t begin = line.find_first_not_of(' ');
  return begin == std::string::npos ? "" : line.substr(begin);
}

/// All lines of the examples and their tests, and each two that follow each other, joined.
std::set<std::string> readCompiledLines() {
  std::set<std::string> lines;
  std::vector<fs::path> files{root / "tests/run/users_shape_test.cpp"};
  for (const char* folder : {"examples/extend", "tests/extend"})
    for (const fs::directory_entry& entry : fs::directory_iterator(root / folder)) files.push_back(entry.path());
  for (const fs::path& path : files) {
    std::ifstream file(path);
    std::string before;
    for (std::string line; std::getline(file, line); before = line) {
      line = withoutMargin(line);
      lines.insert(line);
      lines.insert(before + " " + line);
    }
  }
  return lines;
}

TEST(Guide, ShowsUnderExtendingOnlyLinesThatAreCompiled) {
  const std::set<std::string> compiled = readCompiledLines();
  std::ifstream file(root / "docs/guide.md");
  bool inside = false;
  int shown = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("## ")) inside = line == "## Extending";
    // Code is set in by four blanks, and by seven under a step.
    if (!inside || !line.starts_with("    ")) continue;
    ++shown;
    EXPECT_TRUE(compiled.count(withoutMargin(line))) << line;
  }
  EXPECT_GT(shown, 10);
}

}  // namespace
