// What a checkpoint holds: named columns and values in nested groups, each with unit and description. One walk over the
// data both saves and loads: the owner of a type writes `void describe(Archive&, T&)` once.
//
// In memory an archive is a plain list of data sets; checkpoint.h puts it on disk.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "granular/core/errors.h"
#include "granular/core/math.h"

namespace granular {

/// Unit and meaning of a data set, for whoever opens the file without this program.
struct Note {
  std::string_view unit = "";
  std::string_view description = "";
};

enum class ElementType : std::uint8_t { float64, int32, int64, uint8, uint64, text };

/// One data set: rows of `width` numbers, or a text.
struct DataSet {
  ElementType type = ElementType::float64;
  std::uint64_t rows = 0;
  std::uint64_t width = 1;  ///< numbers per row: 3 for a vector
  bool single = false;      ///< one value, not a column
  std::vector<std::byte> bytes;
  std::string unit, description;
  bool read = false;
};

/// How a C++ type lies in a data set. A row is contiguous in memory.
template <class T>
struct Element;
template <>
struct Element<double> {
  static constexpr ElementType type = ElementType::float64;
  static constexpr std::uint64_t width = 1;
};
template <>
struct Element<std::int32_t> {
  static constexpr ElementType type = ElementType::int32;
  static constexpr std::uint64_t width = 1;
};
template <>
struct Element<std::int64_t> {
  static constexpr ElementType type = ElementType::int64;
  static constexpr std::uint64_t width = 1;
};
template <>
struct Element<std::uint8_t> {
  static constexpr ElementType type = ElementType::uint8;
  static constexpr std::uint64_t width = 1;
};
template <>
struct Element<std::uint64_t> {
  static constexpr ElementType type = ElementType::uint64;
  static constexpr std::uint64_t width = 1;
};
template <>
struct Element<Vec2> {
  static constexpr ElementType type = ElementType::float64;
  static constexpr std::uint64_t width = 2;
};
template <>
struct Element<Vec3> {
  static constexpr ElementType type = ElementType::float64;
  static constexpr std::uint64_t width = 3;
};
/// Eigen's order in memory: x y z w.
template <>
struct Element<Quat> {
  static constexpr ElementType type = ElementType::float64;
  static constexpr std::uint64_t width = 4;
};
template <class T, std::size_t N>
struct Element<std::array<T, N>> {
  static constexpr ElementType type = Element<T>::type;
  static constexpr std::uint64_t width = N * Element<T>::width;
};

/// As its underlying type, unchecked; visitEnum() checks a single one.
template <class E>
requires std::is_enum_v<E>
struct Element<E> : Element<std::underlying_type_t<E>> {
};

template <class T>
concept Storable = requires {
  Element<T>::width;
};

class Archive {
 public:
  /// An empty archive to save into.
  Archive() = default;
  /// A full one to load from; `source` stands for it in messages.
  Archive(std::map<std::string, DataSet> content, std::string source)
      : dataSets(std::move(content)), origin(std::move(source)), isLoading(true) {}

  bool loading() const { return isLoading; }
  const std::map<std::string, DataSet>& content() const { return dataSets; }

  /// A saved archive as one to load from, without a file.
  Archive reopened() const { return Archive(dataSets, "archive"); }

  /// One value. Loading throws InputError if it is missing or of another type.
  template <Storable T>
  void visit(std::string_view name, T& value, const Note& note = {}) {
    if (isLoading) {
      const DataSet& set = expect(name, Element<T>::type, Element<T>::width);
      if (set.rows != 1) failAt(name, "must be a single value");
      std::memcpy(static_cast<void*>(&value), set.bytes.data(), sizeof(T));
    } else {
      put(name, {Element<T>::type, 1, Element<T>::width, true, {}, {}, {}, false}, &value, note);
    }
  }
  void visit(std::string_view name, bool& value, const Note& note = {});
  void visit(std::string_view name, std::string& value, const Note& note = {});
  void visit(std::string_view name, std::vector<std::string>& value, const Note& note = {});

  /// An enumeration whose last value is `last`.
  template <class E>
  requires std::is_enum_v<E>
  void visitEnum(std::string_view name, E& value, E last, const Note& note = {}) {
    auto number = static_cast<std::int32_t>(value);
    visit(name, number, note);
    if (number < 0 || number > static_cast<std::int32_t>(last)) failAt(name, "is out of range");
    value = static_cast<E>(number);
  }

  /// A column. Loading resizes it.
  template <Storable T>
  void visit(std::string_view name, std::vector<T>& column, const Note& note = {}) {
    if (isLoading) {
      const DataSet& set = expect(name, Element<T>::type, Element<T>::width);
      column.resize(set.rows);
      if (set.rows > 0) std::memcpy(static_cast<void*>(column.data()), set.bytes.data(), set.bytes.size());
    } else {
      put(name, {Element<T>::type, column.size(), Element<T>::width, false, {}, {}, {}, false}, column.data(), note);
    }
  }

  /// One member of a list of structures, as a column of its own. Loading: the first member resizes an empty list, the
  /// others must be as long.
  template <class S, Storable T>
  void visitMember(std::string_view name, std::vector<S>& rows, T S::*member, const Note& note = {}) {
    std::vector<T> column;
    if (!isLoading) {
      column.reserve(rows.size());
      for (const S& row : rows) column.push_back(row.*member);
    }
    visit(name, column, note);
    if (!isLoading) return;
    if (rows.empty()) rows.resize(column.size());
    if (rows.size() != column.size()) failAt(name, "is of another length than its neighbours");
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k].*member = column[k];
  }

  /// A group: calls describe(*this, object), found by argument-dependent lookup.
  template <class T>
  void visitGroup(std::string_view name, T& object) {
    inGroup(name, [&] { describe(*this, object); });
  }
  /// A group whose content body() visits.
  template <class Body>
  void inGroup(std::string_view name, Body&& body) {
    const std::string outer = prefix;
    prefix += std::string(name) + '/';
    body();
    prefix = outer;
  }

  /// True if a loaded archive has this data set or group.
  bool has(std::string_view name) const;

  /// Rows of a loaded data set; 0 if it is missing.
  std::uint64_t rowsOf(std::string_view name) const;

  /// Loading: throws InputError naming a data set that nothing has read.
  void requireAllRead() const;

  /// SHA-256 over names, types, shapes and bytes, in order of name: equal states have equal digests.
  std::string digest() const;

 private:
  std::map<std::string, DataSet> dataSets;
  std::string origin;
  std::string prefix;
  bool isLoading = false;

  void put(std::string_view name, DataSet set, const void* data, const Note& note);
  const DataSet& expect(std::string_view name, ElementType type, std::uint64_t width);
  [[noreturn]] void failAt(std::string_view name, const std::string& why) const;
};

/// Bytes of one number of the type.
std::size_t elementSize(ElementType type);

}  // namespace granular
