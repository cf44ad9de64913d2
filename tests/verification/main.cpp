// Runs the verification suite. Beyond GoogleTest's options:
//   --write FILE   write the table of all comparisons (docs/verification.md); refused if a test failed
#include <fmt/format.h>
#include <omp.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "verification/record.h"

namespace granular {
namespace {

struct Section {
  char letter;
  const char* title;
};
constexpr Section sections[] = {{'a', "Single impacts"},
                                {'b', "A frictionless rigid body on a wall"},
                                {'c', "The linear dashpot"},
                                {'d', "Slopes and rolling"},
                                {'e', "Stacks"},
                                {'f', "Columns and flow"},
                                {'h', "Free rotation"},
                                {'i', "Invariances"},
                                {'j', "Binary collisions"},
                                {'k', "Hertz's contact"}};

std::string formatRow(const VerificationRow& row) {
  const std::string error = row.bound ? "" : fmt::format("{:.1e}", std::abs(row.got - row.expected));
  const std::string tolerance = row.bound ? "" : fmt::format("{:.1e}", row.tolerance);
  // Figures that are only bounded may differ in their last digits from machine to machine.
  const std::string got = row.bound ? fmt::format("{:.1e}", row.got) : fmt::format("{:.6g}", row.got);
  return fmt::format("| {} | {}{:.6g} | {} | {} | {} | {} |\n", row.name, row.bound ? "<= " : "", row.expected, got,
                     error, tolerance, row.source);
}

}  // namespace

std::vector<VerificationRow>& verificationRows() {
  static std::vector<VerificationRow> rows;
  return rows;
}

void verify(char group, const std::string& name, double expected, double got, double tolerance,
            const std::string& source) {
  EXPECT_NEAR(got, expected, tolerance) << name;
  verificationRows().push_back({group, name, expected, got, tolerance, source, false});
}

void verifyBelow(char group, const std::string& name, double limit, double got, const std::string& source) {
  EXPECT_GE(got, 0) << name;
  EXPECT_LE(got, limit) << name;
  verificationRows().push_back({group, name, limit, got, 0, source, true});
}

void verifyThat(char group, const std::string& name, bool holds, const std::string& source) {
  verify(group, name, 1, holds, 0, source);
}

std::string formatVerification(std::vector<VerificationRow> rows) {
  std::stable_sort(rows.begin(), rows.end(), [](const VerificationRow& a, const VerificationRow& b) {
    return a.group != b.group ? a.group < b.group : a.name < b.name;
  });
  std::string text =
      "# Verification\n\n"
      "Exact and published numbers beside what the library computes. Written by\n\n"
      "    build/release/tests/test_verification --write docs/verification.md\n\n"
      "and checked, row by row, by the same tests in every run of the suite. The source says where the expected number "
      "comes\n"
      "from and why the tolerance is what it is. Yes-or-no statements read 1 and 0; `<=` marks a limit instead of a "
      "value:\n"
      "what stands beside it is round-off or a step error and differs a little between machines.\n";
  for (const Section& section : sections) {
    const auto mine = [&](const VerificationRow& row) { return row.group == section.letter; };
    if (std::none_of(rows.begin(), rows.end(), mine)) continue;
    text += fmt::format(
        "\n## ({}) {}\n\n| case | expected | got | error | tolerance | source |\n|---|---|---|---|---|---|\n",
        section.letter, section.title);
    for (const VerificationRow& row : rows) {
      if (mine(row)) text += formatRow(row);
    }
  }
  return text;
}

}  // namespace granular

int main(int argc, char** argv) {
  // Threads that wait must not spin where others need the cores. OpenMP reads its settings before main(): start again.
  if (!std::getenv("OMP_WAIT_POLICY")) {
    ::setenv("OMP_WAIT_POLICY", "passive", 1);
    ::execv("/proc/self/exe", argv);
  }
  testing::InitGoogleTest(&argc, argv);
  std::string file;
  for (int k = 1; k < argc; ++k) {
    if (std::strcmp(argv[k], "--write") == 0 && k + 1 < argc) {
      file = argv[++k];
    } else {
      std::fprintf(stderr, "test_verification: unknown option %s; there is --write FILE\n", argv[k]);
      return 2;
    }
  }
  // Most worlds here hold a body or two: threads would only wait for each other.
  omp_set_num_threads(1);
  const int failed = RUN_ALL_TESTS();
  if (failed != 0 || file.empty()) return failed;
  std::ofstream out(file);
  out << granular::formatVerification(granular::verificationRows());
  out.close();
  if (!out) {
    std::fprintf(stderr, "test_verification: %s can't be written\n", file.c_str());
    return 2;
  }
  std::printf("written: %s (%zu rows)\n", file.c_str(), granular::verificationRows().size());
  return 0;
}
