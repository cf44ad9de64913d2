#include "granular/energy/series.h"

#include <algorithm>

namespace granular {

void EnergySeries::record(double time, const EnergyLedger& ledger) {
  if (time < next) return;
  const auto entries = ledger.entries();
  columns = entries.size() + 1;
  const double before = rows() > 0 ? numbers[numbers.size() - columns] : time;
  numbers.push_back(time);
  for (const auto& [name, value] : entries) numbers.push_back(value);
  next = time + interval;
  if (rows() < mostRows) return;

  // Keep every second row, beginning with the first.
  const std::size_t all = rows();
  for (std::size_t k = 2; k < all; k += 2) {
    std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(k * columns), columns,
                numbers.begin() + static_cast<std::ptrdiff_t>(k / 2 * columns));
  }
  numbers.resize((all + 1) / 2 * columns);
  interval = 2 * std::max(interval, time - before);
  next = time + interval;
}

}  // namespace granular
