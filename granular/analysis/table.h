// What the analysis hands out: numbers and tables that carry their own definitions, so that a writer of CSV or JSON
// needs to know nothing of what was measured.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace granular {

/// One measured number; empty where the bed does not define it (JSON: null).
struct Quantity {
  std::string name;        ///< snake_case, stable
  std::string unit;        ///< "m", "N", "1" for a pure number
  std::string definition;  ///< one line
  std::optional<double> value;
};

/// A table of numbers; a cell without a meaning is NaN (CSV: empty; JSON: null).
struct Table {
  std::string name;                  ///< snake_case, stable: the file is <name>.csv
  std::string definition;            ///< one line
  std::vector<std::string> columns;  ///< with the unit as suffix: "height_m"; pure numbers have none
  std::vector<std::vector<double>> rows;
};

}  // namespace granular
