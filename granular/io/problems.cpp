#include "granular/io/problems.h"

#include <fmt/format.h>

#include <algorithm>

#include "granular/core/errors.h"

namespace granular {
namespace {

/// Number of single-character edits between two words.
std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row.back();
}

}  // namespace

void Problems::add(const Place& place, const std::string& path, const std::string& message) {
  std::string where = file.string();
  if (const std::string* given = findOverride(path))
    where = fmt::format("--set {}", *given);
  else if (place.line > 0)
    where += fmt::format(":{}:{}", place.line, place.column);
  const std::string line = fmt::format("{}: {} {}", where, path, message);
  if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
}

void Problems::raise() const { throw InputError(fmt::format("{}", fmt::join(lines, "\n"))); }

const std::string* Problems::findOverride(const std::string& path) const {
  for (const auto& [key, given] : overrides)
    if (path == key || (path.starts_with(key) && path[key.size()] == '.')) return &given;
  return nullptr;
}

std::string suggestName(std::string_view name, std::span<const std::string_view> known) {
  std::string_view best;
  std::size_t distance = std::max<std::size_t>(2, name.size() / 2) + 1;
  for (const std::string_view k : known)
    if (const std::size_t d = editDistance(name, k); d < distance) {
      distance = d;
      best = k;
    }
  return best.empty() ? "" : fmt::format("; did you mean \"{}\"?", best);
}

std::string listNames(std::span<const std::string_view> names) { return fmt::format("{}", fmt::join(names, ", ")); }

}  // namespace granular
