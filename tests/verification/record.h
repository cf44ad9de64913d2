// The verification suite's memory: every comparison with an exact or published number is checked and written down, so
// that the whole table can be printed (docs/verification.md).
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace granular {

/// One line of the table.
struct VerificationRow {
  char group;        ///< letter of the section
  std::string name;  ///< what was computed
  double expected = 0, got = 0;
  double tolerance = 0;  ///< of |got - expected|
  std::string source;    ///< where the expected value and the tolerance come from
  bool bound = false;    ///< expected is an upper limit of got; there is no error to speak of
};

/// All rows so far, in the order of the tests.
std::vector<VerificationRow>& verificationRows();

/// Checks |got - expected| <= tolerance and writes it down.
void verify(char group, const std::string& name, double expected, double got, double tolerance,
            const std::string& source);
/// Checks 0 <= got <= limit and writes it down.
void verifyBelow(char group, const std::string& name, double limit, double got, const std::string& source);
/// Checks a yes-or-no statement: expected 1, got 1 or 0.
void verifyThat(char group, const std::string& name, bool holds, const std::string& source);

/// The table, sorted by section and name.
std::string formatVerification(std::vector<VerificationRow> rows);

}  // namespace granular
