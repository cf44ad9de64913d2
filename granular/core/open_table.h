// A table of named rows: those of the library in the order of their enumeration, and room behind them for a user's own.
// A row is found by its number as in any array, so that an open table costs what a closed one does.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "granular/core/errors.h"

namespace granular {

/// Rows have a `name`, which must live as long as the program: a literal. Kind: an enumeration whose values are row
/// numbers; a user's rows have values beyond those that it names.
template <class Row, class Kind>
class OpenTable {
 public:
  /// The library's rows, and how messages call one.
  template <std::size_t count>
  constexpr OpenTable(std::string_view called, const std::array<Row, count>& rows)
      : what(called), ownCount(count), used(count) {
    static_assert(count <= capacity);
    for (std::size_t k = 0; k < count; ++k) all[k] = rows[k];
  }

  const Row& operator[](Kind kind) const { return all[static_cast<std::size_t>(kind)]; }
  /// True if the row was added by a user.
  bool isUsers(Kind kind) const { return static_cast<std::size_t>(kind) >= ownCount; }

  /// Adds a user's row and returns its kind. Before any thread reads the table. Throws InputError where the name is
  /// empty or taken, and where there is no room.
  Kind add(const Row& row) {
    const std::string name(row.name);
    require(!name.empty(), std::string(what) + " of your own: its row needs a name");
    for (std::size_t k = 0; k < used; ++k)
      require(all[k].name != row.name, std::string(what) + " \"" + name + "\" exists: choose another name");
    require(used < capacity, std::string(what) + " \"" + name + "\": the table is full, with " +
                                 std::to_string(capacity) + " rows; add each row once, at the start of the program");
    all[used] = row;
    return static_cast<Kind>(used++);
  }

  /// Throws InputError that lists the names there are.
  Kind find(std::string_view name) const {
    std::string known;
    for (std::size_t k = 0; k < used; ++k) {
      if (all[k].name == name) return static_cast<Kind>(k);
      known += " \"" + std::string(all[k].name) + "\"";
    }
    throw InputError("unknown " + std::string(what) + " \"" + std::string(name) + "\"; known:" + known);
  }

  /// In the order of the rows.
  std::vector<std::string_view> names() const {
    std::vector<std::string_view> list;
    for (std::size_t k = 0; k < used; ++k) list.push_back(all[k].name);
    return list;
  }

 private:
  static constexpr std::size_t capacity = 32;
  std::string_view what;
  std::size_t ownCount, used;
  std::array<Row, capacity> all{};
};

}  // namespace granular
