// The ledger over time, in a bounded number of rows: when they are full, every second one is dropped and the next ones
// come half as often. No time of the run is left out.
#pragma once

#include <cstddef>
#include <vector>

#include "granular/energy/ledger.h"

namespace granular {

struct EnergySeries {
  static constexpr std::size_t mostRows = 2000;

  double interval = 0;          ///< between rows, s; 0: every call
  double next = 0;              ///< when the next row is due, s
  std::size_t columns = 0;      ///< time and the ledger's entries
  std::vector<double> numbers;  ///< row by row

  std::size_t rows() const { return columns > 0 ? numbers.size() / columns : 0; }

  /// Takes the ledger's entries down if a row is due.
  void record(double time, const EnergyLedger& ledger);
};

}  // namespace granular
