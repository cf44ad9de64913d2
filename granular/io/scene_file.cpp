#include "granular/io/scene_file.h"

// clang-format off
// toml++ 3.3 asserts (with clang: assumes) that a table's name starts well, before it checks it: "[=" would end a debug
// build. Without the assertion its own error follows.
#include <toml++/impl/preprocessor.h>
#undef TOML_ASSERT_ASSUME
#define TOML_ASSERT_ASSUME(...) static_assert(true)
#include <toml++/toml.h>
// clang-format on

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "granular/core/errors.h"
#include "granular/io/problems.h"
#include "granular/io/scene_checks.h"
#include "granular/io/scene_keys.h"
#include "granular/io/toml_characters.h"

namespace granular {
namespace {

namespace fs = std::filesystem;

std::string joinPath(const std::string& path, std::string_view name) {
  return path.empty() ? std::string(name) : path + '.' + std::string(name);
}

/// A value in one line, shortened for a message.
std::string showValue(const toml::node& node) {
  std::ostringstream out;
  // Not as TOML: toml++ 3.3 takes the logarithm of numbers in lists for their length, and numbers below 1 have none.
  if (node.is_array() || node.is_table())
    out << toml::json_formatter(node);
  else
    node.visit([&](const auto& n) { out << n; });
  std::string text;
  for (const char c : out.str()) {
    const bool space = c == ' ' || c == '\n';
    if (!space || (!text.empty() && text.back() != ' ')) text += space ? ' ' : c;
  }
  constexpr std::size_t longest = 80;
  return text.size() <= longest ? text : text.substr(0, longest) + "...";
}

Place placeOf(const toml::source_region& where) { return {where.begin.line, where.begin.column}; }

// ---------------------------------------------------------------------------------------------------- overrides

std::vector<std::string> splitPath(std::string_view path) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    parts.emplace_back(path.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// TOML where it is TOML, otherwise the text itself, so that --set radius=25mm needs no quotes.
toml::table parseOverrideValue(const std::string& value) {
  const std::string text = "value = " + value;
  try {
    if (!findStrayCharacter(text)) return toml::parse(text);
  } catch (const toml::parse_error&) {
  }
  toml::table table;
  table.insert("value", value);
  return table;
}

/// The child of a table or array that a path names; tables that aren't there yet are made.
toml::node* enterChild(toml::node& parent, const std::string& name, const std::string& given) {
  if (toml::table* table = parent.as_table()) {
    if (!table->contains(name)) table->insert(name, toml::table{});
    return table->get(name);
  }
  toml::array* array = parent.as_array();
  if (!array) throw InputError(fmt::format("--set {}: nothing lies below a single value", given));
  std::size_t index = 0;
  const bool isNumber = !name.empty() && name.size() < 9 && name.find_first_not_of("0123456789") == std::string::npos;
  if (isNumber) index = std::stoul(name);
  if (!isNumber || index >= array->size())
    throw InputError(
        fmt::format("--set {}: \"{}\" is no element; there are {}, numbered from 0", given, name, array->size()));
  return array->get(index);
}

void applyOverride(toml::table& root, const std::string& given, Problems& problems) {
  const std::size_t equals = given.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InputError(fmt::format("--set {}: must have the form key.path=value", given));
  std::vector<std::string> parts = splitPath(given.substr(0, equals));

  // A single word that names a parameter sets it.
  const toml::table* parameters = root["parameters"].as_table();
  if (parts.size() == 1 && parameters && parameters->contains(parts[0])) parts.insert(parts.begin(), "parameters");

  toml::node* parent = &root;
  for (std::size_t k = 0; k + 1 < parts.size(); ++k) parent = enterChild(*parent, parts[k], given);
  if (equals + 1 == given.size()) {
    // Nothing behind the sign: the key is taken out, as when another kind has no use for it.
    toml::table* table = parent->as_table();
    if (!table || table->erase(parts.back()) == 0)
      throw InputError(fmt::format("--set {}: there is no such key to take out", given));
    return;
  }
  toml::table value = parseOverrideValue(given.substr(equals + 1));
  const toml::node& node = *value.get("value");
  if (toml::table* table = parent->as_table()) {
    node.visit([&](const auto& n) { table->insert_or_assign(parts.back(), n); });
  } else if (toml::array* array = parent->as_array()) {
    enterChild(*parent, parts.back(), given);
    const auto index = static_cast<std::ptrdiff_t>(std::stoul(parts.back()));
    node.visit([&](const auto& n) { array->replace(array->cbegin() + index, n); });
  } else {
    throw InputError(fmt::format("--set {}: nothing lies below a single value", given));
  }
  problems.addOverride(fmt::format("{}", fmt::join(parts, ".")), given);
}

// ---------------------------------------------------------------------------------------------------- reader

class SceneReader : public KeyVisitor {
 public:
  SceneReader(const toml::table& root, fs::path sceneFolder, Problems& collected)
      : folder(std::move(sceneFolder)), problems(collected) {
    level.table = &root;
    level.known.insert("parameters");
    readParameters(root);
  }

  /// What remains to be said when all keys are read.
  void finish() {
    reportUnknown();
    for (const auto& [name, parameter] : parameters)
      if (!parameter.used)
        problems.add(parameter.where, "parameters." + name, "isn't used by any expression of the scene");
  }

  /// Where a path given by a check lies: the deepest part of it that is in the file.
  Place locate(const std::string& path) const {
    const toml::node* node = level.table;
    Place where = placeOf(node->source());
    for (const std::string& part : splitPath(path)) {
      if (const toml::array* array = node->as_array())
        node = array->get(std::stoul(part));
      else
        node = node->is_table() ? node->as_table()->get(part) : nullptr;
      if (!node) break;
      where = placeOf(node->source());
    }
    return where;
  }

  void readNumber(const Key& key, double& value, Dimension dimension, const Range& range) override {
    if (const toml::node* node = find(key)) takeNumber(*node, pathOf(key), value, dimension, range);
  }

  void readUnit(const Key& key, double& value) override {
    const toml::node* node = find(key);
    if (!node) return;
    const std::string* name = node->is_string() ? &node->as_string()->get() : nullptr;
    if (!name || !isUnitName(*name)) {
      takeNumber(*node, pathOf(key), value, Dimension::length, {0, infinity, true});
      return;
    }
    try {
      value = toSi(parseQuantity("1 " + *name), Dimension::length);
    } catch (const InputError& error) {
      fail(*node, pathOf(key), error.what());
    }
  }

  void readOptional(const Key& key, std::optional<double>& value, Dimension dimension, const Range& range) override {
    const toml::node* node = find(key);
    if (!node) return;
    value.reset();
    if (node->is_string() && node->as_string()->get() == "auto") return;
    double number = 0;
    if (takeNumber(*node, pathOf(key), number, dimension, range, "\"auto\", or ")) value = number;
  }

  void readInteger(const Key& key, std::int64_t& value, const Range& range) override {
    const toml::node* node = find(key);
    if (!node) return;
    double number = 0;
    if (!takeNumber(*node, pathOf(key), number, Dimension::none, range)) return;
    if (number != std::floor(number) || std::abs(number) > 9e15)
      return fail(*node, pathOf(key), "must be a whole number");
    value = node->is_integer() ? node->as_integer()->get() : static_cast<std::int64_t>(number);
  }

  void readBoolean(const Key& key, bool& value) override {
    const toml::node* node = find(key);
    if (!node) return;
    if (!node->is_boolean()) return fail(*node, pathOf(key), "must be true or false");
    value = node->as_boolean()->get();
  }

  void readText(const Key& key, std::string& value) override {
    if (const toml::node* node = find(key)) takeText(*node, pathOf(key), value);
  }

  void readFile(const Key& key, fs::path& value) override {
    if (const toml::node* node = find(key)) takeFile(*node, pathOf(key), value);
  }

  void readFiles(const Key& key, std::vector<fs::path>& value) override {
    const toml::node* node = find(key);
    if (!node) return;
    value.clear();
    forEachOrOne(*node, pathOf(key), [&](const toml::node& element, const std::string& path) {
      takeFile(element, path, value.emplace_back());
    });
  }

  void readVector(const Key& key, Vec3& value, Dimension dimension, const Range& range) override {
    if (const toml::node* node = find(key)) takeVector(*node, pathOf(key), value, dimension, range);
  }

  void readPoints(const Key& key, std::vector<Vec3>& value, Dimension dimension) override {
    const toml::node* node = find(key);
    if (!node) return;
    const toml::array* array = node->as_array();
    if (!array) return fail(*node, pathOf(key), "must be a list of points [[x, y, z], ...]");
    value.assign(array->size(), Vec3::Zero());
    for (std::size_t k = 0; k < array->size(); ++k)
      takeVector(*array->get(k), joinPath(pathOf(key), std::to_string(k)), value[k], dimension,
                 {-infinity, infinity, true, true});
  }

  void readNumbers(const Key& key, std::vector<double>& value, Dimension dimension, const Range& range) override {
    const toml::node* node = find(key);
    if (!node) return;
    value.clear();
    forEachOrOne(*node, pathOf(key), [&](const toml::node& element, const std::string& path) {
      takeNumber(element, path, value.emplace_back(), dimension, range);
    });
  }

  void readInterval(const Key& key, Interval& value, Dimension dimension, const Range& range) override {
    const toml::node* node = find(key);
    if (!node) return;
    std::vector<double> ends;
    bool good = true;
    forEachOrOne(*node, pathOf(key), [&](const toml::node& element, const std::string& path) {
      good = takeNumber(element, path, ends.emplace_back(), dimension, range) && good;
    });
    if (!good) return;
    if (ends.empty() || ends.size() > 2 || ends.front() > ends.back())
      return fail(*node, pathOf(key), "must be one number, or [smallest, largest]");
    value = {ends.front(), ends.back()};
  }

  void readNames(const Key& key, std::vector<std::string>& value, std::span<const std::string_view> choices) override {
    const toml::node* node = find(key);
    if (!node) return;
    value.clear();
    forEachOrOne(*node, pathOf(key), [&](const toml::node& element, const std::string& path) {
      std::string& name = value.emplace_back();
      if (!takeText(element, path, name) || choices.empty()) return;
      if (std::find(choices.begin(), choices.end(), name) == choices.end())
        fail(element, path, fmt::format("must be one of {}{}", listNames(choices), suggestName(name, choices)));
    });
  }

  void readChoice(const Key& key, std::size_t& index, std::span<const std::string_view> choices) override {
    const toml::node* node = find(key);
    std::string name;
    if (!node || !takeText(*node, pathOf(key), name)) return;
    const auto found = std::find(choices.begin(), choices.end(), name);
    if (found == choices.end())
      return fail(*node, pathOf(key),
                  fmt::format("must be one of {}{}", listNames(choices), suggestName(name, choices)));
    index = static_cast<std::size_t>(found - choices.begin());
  }

  void readTable(const Key& key, const std::function<void()>& body) override {
    const toml::node* node = find(key);
    if (!node) return;
    if (!node->is_table()) return fail(*node, pathOf(key), fmt::format("must be a table: [{}]", pathOf(key)));
    enter(*node->as_table(), pathOf(key), body);
  }

  void readTables(const Key& key, const std::function<void(std::size_t)>& resize,
                  const std::function<void(std::size_t)>& body) override {
    const toml::node* node = find(key);
    if (!node) return;
    const toml::array* array = node->as_array();
    const bool tables =
        array && std::all_of(array->begin(), array->end(), [](const toml::node& n) { return n.is_table(); });
    if (!tables)
      return fail(*node, pathOf(key), fmt::format("must be a list of tables, each headed by [[{}]]", key.name));
    resize(array->size());
    for (std::size_t k = 0; k < array->size(); ++k)
      enter(*array->get(k)->as_table(), joinPath(pathOf(key), std::to_string(k)), [&] { body(k); });
  }

  int line() const override { return static_cast<int>(level.table->source().begin.line); }

 private:
  /// A table being read.
  struct Level {
    const toml::table* table = nullptr;
    std::string path;
    std::set<std::string> known;

    std::vector<std::string_view> knownNames() const { return {known.begin(), known.end()}; }
  };
  struct Parameter {
    UnitValue quantity;
    Place where;
    bool used = false;
  };

  fs::path folder;
  Problems& problems;
  Level level;
  std::map<std::string, Parameter> parameters;

  std::string pathOf(const Key& key) const { return joinPath(level.path, key.name); }

  void fail(const toml::node& node, const std::string& path, const std::string& message) {
    problems.add(placeOf(node.source()), path, fmt::format("= {}: {}", showValue(node), message));
  }

  /// Registers the key and finds its value; reports one that is missing, or given although the kind has none.
  const toml::node* find(const Key& key) {
    const toml::node* node = level.table->get(key.name);
    if (!applies(key)) {
      // Known to another kind of the section: say so.
      if (!node) return nullptr;
      level.known.insert(std::string(key.name));
      std::string kinds(key.only);
      std::replace(kinds.begin(), kinds.end(), '|', ',');
      fail(*node, pathOf(key), fmt::format("isn't used by kind \"{}\"; it belongs to: {}", kind, kinds));
      return nullptr;
    }
    level.known.insert(std::string(key.name));
    if (!node && key.required)
      problems.add(placeOf(level.table->source()), pathOf(key), fmt::format("is missing: {}", key.doc));
    return node;
  }

  void enter(const toml::table& table, const std::string& path, const std::function<void()>& body) {
    Level outer = std::move(level);
    const std::string_view outerKind = kind;
    level = {&table, path, {}};
    kind = {};
    body();
    reportUnknown();
    level = std::move(outer);
    kind = outerKind;
  }

  void reportUnknown() {
    for (const auto& [key, node] : *level.table)
      if (!level.known.contains(std::string(key.str())))
        problems.add(placeOf(key.source()), joinPath(level.path, key.str()),
                     fmt::format("= {}: unknown key{}; known here: {}", showValue(node),
                                 suggestName(key.str(), level.knownNames()), listNames(level.knownNames())));
  }

  template <class Take>
  void forEachOrOne(const toml::node& node, const std::string& path, Take&& take) {
    const toml::array* array = node.as_array();
    if (!array) return take(node, path);
    for (std::size_t k = 0; k < array->size(); ++k) take(*array->get(k), joinPath(path, std::to_string(k)));
  }

  /// The quantity a string spells: an expression after "=", otherwise a number with its unit.
  UnitValue evaluateText(std::string_view text) {
    if (!text.starts_with('=')) return parseQuantity(text);
    return evaluateExpression(text.substr(1), [this](std::string_view name) -> const UnitValue* {
      const auto found = parameters.find(std::string(name));
      if (found == parameters.end()) return nullptr;
      found->second.used = true;
      return &found->second.quantity;
    });
  }

  /// Reads one number and checks dimension and range; false, with a problem reported, if it isn't one.
  bool takeNumber(const toml::node& node, const std::string& path, double& value, Dimension dimension,
                  const Range& range, const std::string& instead = "") {
    const std::string_view si = siUnit(dimension);
    const std::string what = dimension == Dimension::none
                                 ? instead + "a plain number, a string in %, or an expression \"= ...\""
                                 : fmt::format("{}{}: a number in {}, or a string with a unit (units: {})", instead,
                                               withArticle(dimensionName(dimension)), si, acceptedUnits(dimension));
    double number = 0;
    if (node.is_integer()) {
      number = static_cast<double>(node.as_integer()->get());
    } else if (node.is_floating_point()) {
      number = node.as_floating_point()->get();
    } else if (node.is_string()) {
      const std::string& text = node.as_string()->get();
      try {
        const UnitValue quantity = evaluateText(text);
        number = toSi(quantity, dimension);
        if (!text.starts_with('=') && !quantity.hasUnit && dimension != Dimension::none)
          return fail(node, path, "has no unit; it must be " + what), false;
      } catch (const InputError& error) {
        return fail(node, path, fmt::format("{}; it must be {}", error.what(), what)), false;
      }
    } else {
      return fail(node, path, "must be " + what), false;
    }
    if (std::isnan(number) || !range.holds(number)) {
      const std::string allowed = range.describe(dimension);
      return fail(node, path, allowed.empty() ? "must be a finite number" : "must be " + allowed), false;
    }
    value = number;
    return true;
  }

  void takeVector(const toml::node& node, const std::string& path, Vec3& value, Dimension dimension,
                  const Range& range) {
    const toml::array* array = node.as_array();
    if (!array || array->size() != 3) return fail(node, path, "must be a list of three: [x, y, z]");
    for (std::size_t k = 0; k < 3; ++k) {
      double component = 0;
      const std::string elementPath = joinPath(path, std::to_string(k));
      if (!takeNumber(*array->get(k), elementPath, component, dimension, range)) continue;
      value[static_cast<Eigen::Index>(k)] = component;
    }
  }

  bool takeText(const toml::node& node, const std::string& path, std::string& value) {
    if (!node.is_string() || node.as_string()->get().empty())
      return fail(node, path, "must be a text in quotes"), false;
    value = node.as_string()->get();
    return true;
  }

  void takeFile(const toml::node& node, const std::string& path, fs::path& value) {
    std::string text;
    if (!takeText(node, path, text)) return;
    value = fs::absolute(folder / text).lexically_normal();
    std::error_code error;
    if (!fs::exists(value, error)) fail(node, path, fmt::format("there is no such file: {}", value.string()));
  }

  /// Evaluates [parameters] in the order they are written, so that later ones may use earlier ones.
  void readParameters(const toml::table& root) {
    const toml::node* node = root.get("parameters");
    if (!node) return;
    if (!node->is_table()) return fail(*node, "parameters", "must be a table: [parameters]");
    std::vector<std::pair<const toml::key*, const toml::node*>> entries;
    for (const auto& [key, value] : *node->as_table()) entries.emplace_back(&key, &value);
    std::stable_sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) {
      return std::pair(a.first->source().begin.line, a.first->source().begin.column) <
             std::pair(b.first->source().begin.line, b.first->source().begin.column);
    });
    for (const auto& [key, value] : entries) readParameter(std::string(key->str()), *key, *value);
  }

  void readParameter(const std::string& name, const toml::key& key, const toml::node& node) {
    const std::string path = "parameters." + name;
    if (isUnitName(name)) return problems.add(placeOf(key.source()), path, "has the name of a unit; choose another");
    Parameter parameter;
    parameter.where = placeOf(key.source());
    if (node.is_number()) {
      parameter.quantity.value = node.value<double>().value();
    } else if (node.is_string()) {
      try {
        parameter.quantity = evaluateText(node.as_string()->get());
      } catch (const InputError& error) {
        return fail(node, path, error.what());
      }
    } else {
      return fail(node, path, "must be a number, a quantity with a unit, or an expression \"= ...\"");
    }
    parameters[name] = parameter;
  }
};

}  // namespace

Scene parseScene(std::string_view text, const fs::path& path, const std::vector<std::string>& overrides) {
  if (const auto stray = findStrayCharacter(text)) {
    const std::string_view before = text.substr(0, *stray);
    throw InputError(
        fmt::format("{}:{}:{}: a letter or sign beyond ASCII outside of quotes and comments; keys have none",
                    path.string(), 1 + std::count(before.begin(), before.end(), '\n'),
                    1 + *stray - std::min(before.size(), before.rfind('\n') + 1)));
  }
  toml::table root;
  try {
    root = toml::parse(text, path.string());
  } catch (const toml::parse_error& error) {
    const toml::source_position at = error.source().begin;
    throw InputError(
        fmt::format("{}:{}:{}: not valid TOML: {}", path.string(), at.line, at.column, error.description()));
  }
  Problems problems(path);
  for (const std::string& override : overrides) applyOverride(root, override, problems);

  Scene scene;
  scene.file = path;
  scene.name = path.stem().string();
  SceneReader reader(root, path.parent_path(), problems);
  visitScene(reader, scene);
  reader.finish();
  if (problems.any()) problems.raise();

  // What the keys must satisfy together, once each is right by itself.
  if (scene.materials.empty()) scene.materials.emplace_back().name = "default";
  checkScene(scene, [&](const std::string& key, const std::string& message) {
    problems.add(reader.locate(key), key, message);
  });
  if (problems.any()) problems.raise();
  return scene;
}

Scene readScene(const fs::path& path, const std::vector<std::string>& overrides) {
  std::ifstream file(path, std::ios::binary);
  if (!file || fs::is_directory(path))
    throw InputError(fmt::format("{}: the scene can't be read: no such file", path.string()));
  std::ostringstream text;
  text << file.rdbuf();
  return parseScene(text.str(), path, overrides);
}

}  // namespace granular
