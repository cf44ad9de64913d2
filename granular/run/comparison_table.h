// The table of a comparison: one row per case, on disk after each, so that a comparison that was stopped goes on where
// it was.
#pragma once

#include <filesystem>
#include <memory>

#include "granular/run/comparison_engine.h"

namespace granular {

class ComparisonTable {
 public:
  /// Reads folder/contacts.json if it is there. Throws InputError if the folder can't be written into or the file is
  /// not such a table.
  explicit ComparisonTable(std::filesystem::path folder);
  ~ComparisonTable();

  bool has(const ComparisonCase& which) const;
  std::size_t size() const;
  /// Adds or replaces the row of a case and writes contacts.json and contacts.csv, whole or not at all, and the bodies
  /// as the case leaves them in states/NAME.csv.
  void add(const ComparisonCase& which, const ComparisonResult& result);

 private:
  struct Rows;
  std::filesystem::path folder;
  std::unique_ptr<Rows> rows;
};

/// One line for the user.
std::string describeResult(const ComparisonCase& which, const ComparisonResult& result);
/// The scenes with what theory says of each, and where it is known from.
std::string describeScenes();

}  // namespace granular
