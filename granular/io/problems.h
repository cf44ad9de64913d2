// Problems of a scene, collected with their places so that a user sees all of them at once.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace granular {

/// A place in the scene file, counted from 1; line 0: none.
struct Place {
  unsigned line = 0, column = 0;
};

class Problems {
 public:
  explicit Problems(std::filesystem::path scene) : file(std::move(scene)) {}

  /// Remembers that `given` ("key.path=value") set the key at `path`: its problems name it instead of a line.
  void addOverride(const std::string& path, const std::string& given) { overrides[path] = given; }

  /// path: the key ("particles.0.radius"); message: what is wrong and what is allowed.
  void add(const Place& place, const std::string& path, const std::string& message);

  bool any() const { return !lines.empty(); }
  /// Throws InputError with one line per problem.
  [[noreturn]] void raise() const;

 private:
  std::filesystem::path file;
  std::map<std::string, std::string> overrides;
  std::vector<std::string> lines;

  /// The override that set this path or a parent of it.
  const std::string* findOverride(const std::string& path) const;
};

/// "; did you mean "radius"?" for the known name with the fewest single-character edits, or nothing where none is
/// close.
std::string suggestName(std::string_view name, std::span<const std::string_view> known);
/// "a, b, c".
std::string listNames(std::span<const std::string_view> names);

}  // namespace granular
