// The table of all keys of a scene: name, kind, unit, default, range, meaning. One function walks it; a visitor reads a
// file by it, another prints it, so that what is checked and what is documented can't differ.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "granular/core/units.h"
#include "granular/io/scene.h"

namespace granular {

/// What values a key allows.
struct Range {
  double lo = -infinity, hi = infinity;
  bool loOpen = false, hiOpen = false;

  bool holds(double value) const;
  /// "> 0 m", "0 to 1"; empty if anything goes.
  std::string describe(Dimension dimension) const;
};

struct Key {
  std::string_view name;
  std::string_view doc;
  /// The kinds of its section that have this key, as "cylinder|cone"; empty: all.
  std::string_view only = {};
  bool required = false;
};

class KeyVisitor {
 public:
  virtual ~KeyVisitor() = default;

  virtual void readNumber(const Key&, double&, Dimension, const Range&) = 0;
  /// A length unit by its name, or a length.
  virtual void readUnit(const Key&, double&) = 0;
  /// "auto" or nothing leaves the value empty.
  virtual void readOptional(const Key&, std::optional<double>&, Dimension, const Range&) = 0;
  virtual void readInteger(const Key&, std::int64_t&, const Range&) = 0;
  virtual void readBoolean(const Key&, bool&) = 0;
  virtual void readText(const Key&, std::string&) = 0;
  /// A file that must exist; relative to the scene's folder.
  virtual void readFile(const Key&, std::filesystem::path&) = 0;
  virtual void readFiles(const Key&, std::vector<std::filesystem::path>&) = 0;
  virtual void readVector(const Key&, Vec3&, Dimension, const Range&) = 0;
  virtual void readPoints(const Key&, std::vector<Vec3>&, Dimension) = 0;
  virtual void readNumbers(const Key&, std::vector<double>&, Dimension, const Range&) = 0;
  /// One number or [lo, hi].
  virtual void readInterval(const Key&, Interval&, Dimension, const Range&) = 0;
  /// A list of names; a single name is a list of one. Empty choices: any text.
  virtual void readNames(const Key&, std::vector<std::string>&, std::span<const std::string_view> choices) = 0;
  virtual void readChoice(const Key&, std::size_t& index, std::span<const std::string_view> choices) = 0;
  virtual void readTable(const Key&, const std::function<void()>& body) = 0;
  /// An array of tables: resize is called with their number, then body for each.
  virtual void readTables(const Key&, const std::function<void(std::size_t)>& resize,
                          const std::function<void(std::size_t)>& body) = 0;
  /// Line of the table being read; 0 where there is none.
  virtual int line() const { return 0; }

  /// A choice whose names follow the order of the enumeration.
  template <class E>
  void readEnum(const Key& key, E& value, std::span<const std::string_view> names) {
    auto index = static_cast<std::size_t>(value);
    readChoice(key, index, names);
    value = static_cast<E>(index);
  }
  /// The choice that decides which other keys of its section exist (Key::only).
  template <class E>
  void readKind(const Key& key, E& value, std::span<const std::string_view> names) {
    readEnum(key, value, names);
    kind = names[static_cast<std::size_t>(value)];
  }
  /// Keys of the section being read depend on a choice made in another one (Key::only).
  void setKind(std::string_view chosen) { kind = chosen; }

 protected:
  /// True if the section's kind has this key.
  bool applies(const Key& key) const;
  std::string_view kind;  ///< of the section being read; empty: none
};

/// Walks all keys in the order of the documentation.
void visitScene(KeyVisitor& visitor, Scene& scene);

}  // namespace granular
