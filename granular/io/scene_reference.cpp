// Prints the key table: the reference of scene files.
#include <fmt/format.h>
#include <fmt/ostream.h>

#include <ostream>

#include "granular/io/scene_file.h"
#include "granular/io/scene_keys.h"

namespace granular {
namespace {

class ReferencePrinter : public KeyVisitor {
 public:
  explicit ReferencePrinter(std::ostream& stream) : out(stream) {}

  void readNumber(const Key& key, double& value, Dimension dimension, const Range& range) override {
    print(key, std::string(dimensionName(dimension)), range.describe(dimension), showNumber(value, dimension));
  }
  void readUnit(const Key& key, double&) override { print(key, "name of a length unit, or a length", "", ""); }
  void readOptional(const Key& key, std::optional<double>& value, Dimension dimension, const Range& range) override {
    print(key, std::string(dimensionName(dimension)) + " or \"auto\"", range.describe(dimension),
          value ? showNumber(*value, dimension) : "\"auto\"");
  }
  void readInteger(const Key& key, std::int64_t& value, const Range& range) override {
    print(key, "whole number", range.describe(Dimension::none), std::to_string(value));
  }
  void readBoolean(const Key& key, bool& value) override { print(key, "true or false", "", value ? "true" : "false"); }
  void readText(const Key& key, std::string& value) override { print(key, "text", "", value); }
  void readFile(const Key& key, std::filesystem::path&) override { print(key, "file", "", ""); }
  void readFiles(const Key& key, std::vector<std::filesystem::path>&) override { print(key, "list of files", "", ""); }
  void readVector(const Key& key, Vec3& value, Dimension dimension, const Range& range) override {
    print(key, fmt::format("[x, y, z], each {}", withArticle(dimensionName(dimension))), range.describe(dimension),
          fmt::format("[{:g}, {:g}, {:g}]", value.x(), value.y(), value.z()));
  }
  void readPoints(const Key& key, std::vector<Vec3>&, Dimension dimension) override {
    print(key, fmt::format("[[x, y, z], ...], each {}", withArticle(dimensionName(dimension))), "", "");
  }
  void readNumbers(const Key& key, std::vector<double>&, Dimension dimension, const Range& range) override {
    print(key, fmt::format("list, each {}", withArticle(dimensionName(dimension))), range.describe(dimension), "");
  }
  void readInterval(const Key& key, Interval& value, Dimension dimension, const Range& range) override {
    print(key, fmt::format("{}, or [smallest, largest]", dimensionName(dimension)), range.describe(dimension),
          value.hi > 0 ? fmt::format("[{:g}, {:g}]{}", value.lo, value.hi, unitSuffix(dimension)) : "");
  }
  void readNames(const Key& key, std::vector<std::string>& value, std::span<const std::string_view> choices) override {
    print(key, "name or list of names", fmt::format("{}", fmt::join(choices, ", ")),
          fmt::format("{}", fmt::join(value, ", ")));
  }
  void readChoice(const Key& key, std::size_t& index, std::span<const std::string_view> choices) override {
    print(key, "one of", fmt::format("{}", fmt::join(choices, ", ")), std::string(choices[index]));
  }
  void readTable(const Key& key, const std::function<void()>& body) override {
    heading(fmt::format("[{}{}]", path, key.name), key, body);
  }
  void readTables(const Key& key, const std::function<void(std::size_t)>& resize,
                  const std::function<void(std::size_t)>& body) override {
    resize(1);
    heading(fmt::format("[[{}{}]]", path, key.name), key, [&] { body(0); });
  }

 private:
  std::ostream& out;
  std::string path;

  static std::string unitSuffix(Dimension dimension) {
    return dimension == Dimension::none ? "" : fmt::format(" {}", siUnit(dimension));
  }
  static std::string showNumber(double value, Dimension dimension) {
    return fmt::format("{:g}{}", value, value == infinity ? "" : unitSuffix(dimension));
  }

  void heading(const std::string& title, const Key& key, const std::function<void()>& body) {
    fmt::print(out, "\n{}  {}{}\n", title, key.doc, key.required ? " (needed)" : "");
    const std::string outer = path;
    path += std::string(key.name) + '.';
    body();
    path = outer;
  }

  void print(const Key& key, const std::string& what, const std::string& allowed, const std::string& value) {
    std::string only(key.only);
    for (std::size_t at = 0; (at = only.find('|', at)) != std::string::npos;) only.replace(at, 1, ", ");
    fmt::print(out, "  {:<24}{}\n", key.name, key.doc);
    std::string line = what;
    if (!allowed.empty()) line += fmt::format(": {}", allowed);
    if (key.required)
      line += "; needed";
    else if (!value.empty())
      line += fmt::format("; default {}", value);
    if (!only.empty()) line += fmt::format("; for {}", only);
    fmt::print(out, "  {:<24}{}\n", "", line);
  }
};

}  // namespace

void printSceneReference(std::ostream& out) {
  fmt::print(out,
             "A scene is a TOML file. Numbers are in SI units, or strings with a unit (\"25 mm\"), or expressions\n"
             "(\"= 1.5 mm * aspect_ratio\") with + - * / ^ ( ) sqrt cbrt abs min max and the names in [parameters].\n"
             "m: mean mass, g: gravity, d: mean size (diameter of the sphere of equal volume).\n\n"
             "[parameters]  named numbers or quantities for expressions; --set NAME=VALUE changes one\n\n");
  Scene scene;
  ReferencePrinter printer(out);
  visitScene(printer, scene);
}

}  // namespace granular
