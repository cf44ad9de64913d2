#include "granular/core/units.h"

#include <charconv>
#include <cmath>
#include <string>
#include <utility>

#include "granular/core/errors.h"

namespace granular {
namespace {

using Powers = std::array<int, 4>;  // of m, kg, s, rad

struct Unit {
  std::string_view name;
  double factor;
  Powers powers;
};

constexpr double radiansPerDegree = 0.017453292519943295;
constexpr double radiansPerTurn = 6.283185307179586;

constexpr Powers number{0, 0, 0, 0}, metre{1, 0, 0, 0}, kilogram{0, 1, 0, 0}, second{0, 0, 1, 0}, radian{0, 0, 0, 1};
constexpr Powers newton{1, 1, -2, 0}, joule{2, 1, -2, 0}, pascal{-1, 1, -2, 0}, hertz{0, 0, -1, 0};

constexpr Unit units[] = {
    {"m", 1, metre},
    {"km", 1e3, metre},
    {"cm", 1e-2, metre},
    {"mm", 1e-3, metre},
    {"um", 1e-6, metre},
    {"\u00b5m", 1e-6, metre},
    {"\u03bcm", 1e-6, metre},
    {"nm", 1e-9, metre},
    {"s", 1, second},
    {"ms", 1e-3, second},
    {"us", 1e-6, second},
    {"\u00b5s", 1e-6, second},
    {"\u03bcs", 1e-6, second},
    {"ns", 1e-9, second},
    {"min", 60, second},
    {"h", 3600, second},
    {"kg", 1, kilogram},
    {"g", 1e-3, kilogram},
    {"mg", 1e-6, kilogram},
    {"ug", 1e-9, kilogram},
    {"t", 1e3, kilogram},
    {"N", 1, newton},
    {"kN", 1e3, newton},
    {"MN", 1e6, newton},
    {"mN", 1e-3, newton},
    {"uN", 1e-6, newton},
    {"J", 1, joule},
    {"kJ", 1e3, joule},
    {"mJ", 1e-3, joule},
    {"uJ", 1e-6, joule},
    {"nJ", 1e-9, joule},
    {"Pa", 1, pascal},
    {"kPa", 1e3, pascal},
    {"MPa", 1e6, pascal},
    {"GPa", 1e9, pascal},
    {"Hz", 1, hertz},
    {"kHz", 1e3, hertz},
    {"rad", 1, radian},
    {"deg", radiansPerDegree, radian},
    {"\u00b0", radiansPerDegree, radian},
    {"rev", radiansPerTurn, radian},
    {"rpm", radiansPerTurn / 60, {0, 0, -1, 1}},
    {"%", 1e-2, number},
};

struct DimensionRow {
  std::string_view name, si, accepted;
  Powers powers;
};

// In the order of the enumeration.
constexpr DimensionRow dimensions[] = {
    {"plain number", "", "a number, or %", number},
    {"length", "m", "m, cm, mm, um, nm, km", metre},
    {"area", "m^2", "m^2, cm^2, mm^2", {2, 0, 0, 0}},
    {"volume", "m^3", "m^3, cm^3, mm^3", {3, 0, 0, 0}},
    {"time", "s", "s, ms, us, ns, min, h", second},
    {"mass", "kg", "kg, g, mg, ug, t", kilogram},
    {"density", "kg/m^3", "kg/m^3, g/cm^3, t/m^3", {-3, 1, 0, 0}},
    {"stiffness", "N/m", "N/m, kN/m, N/mm", {0, 1, -2, 0}},
    {"velocity", "m/s", "m/s, mm/s, cm/s", {1, 0, -1, 0}},
    {"acceleration", "m/s^2", "m/s^2, mm/s^2", {1, 0, -2, 0}},
    {"angle", "rad", "rad, deg, rev", radian},
    {"angular velocity", "rad/s", "rad/s, deg/s, rpm", {0, 0, -1, 1}},
    {"frequency", "Hz", "Hz, kHz, 1/s", hertz},
    {"rate", "1/s", "1/s, 1/min, Hz", hertz},
    {"force", "N", "N, kN, mN, uN", newton},
    {"energy", "J", "J, mJ, uJ, nJ, kJ", joule},
    {"pressure", "Pa", "Pa, kPa, MPa, GPa", pascal},
};

const DimensionRow& row(Dimension dimension) { return dimensions[static_cast<std::size_t>(dimension)]; }

const Unit* findUnit(std::string_view name) {
  for (const Unit& unit : units)
    if (unit.name == name) return &unit;
  return nullptr;
}

/// "a mass", or the powers of the base units where no name fits.
std::string describePowers(const Powers& powers) {
  for (const DimensionRow& d : dimensions)
    if (d.powers == powers) return std::string(d.name);
  static constexpr std::string_view bases[] = {"m", "kg", "s", "rad"};
  std::string text;
  for (std::size_t k = 0; k < 4; ++k)
    if (powers[k] != 0) {
      text += text.empty() ? "" : " ";
      text += bases[k];
      if (powers[k] != 1) text += '^' + std::to_string(powers[k]);
    }
  return text;
}

/// Recursive descent over one expression. Plain quantities are its subset with one leading number.
class Parser {
 public:
  Parser(std::string_view source, const UnitValueLookup* lookupName) : text(source), lookup(lookupName) {}

  UnitValue parse() {
    const UnitValue result = parseSum();
    skipSpace();
    if (at < text.size()) fail("unexpected \"" + std::string(text.substr(at)) + "\"");
    if (!std::isfinite(result.value)) fail("not a finite number");
    return result;
  }

 private:
  std::string_view text;
  const UnitValueLookup* lookup;  ///< nullptr: a plain quantity, number and unit only
  std::size_t at = 0;
  int numbersSeen = 0;
  int depth = 0;

  [[noreturn]] void fail(const std::string& why) const { throw InputError('"' + std::string(text) + "\": " + why); }

  void skipSpace() {
    while (at < text.size() && (text[at] == ' ' || text[at] == '\t')) ++at;
  }
  char peek() {
    skipSpace();
    return at < text.size() ? text[at] : '\0';
  }
  bool take(char c) {
    if (peek() != c) return false;
    ++at;
    return true;
  }

  static bool startsName(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '%' || static_cast<signed char>(c) < 0;
  }
  static bool continuesName(char c) { return startsName(c) || (c >= '0' && c <= '9'); }

  std::string_view takeName() {
    skipSpace();
    const std::size_t begin = at;
    while (at < text.size() && continuesName(text[at])) ++at;
    return text.substr(begin, at - begin);
  }

  UnitValue parseSum() {
    if (++depth > 50) fail("too deeply nested");
    UnitValue sum = parseProduct();
    while (peek() == '+' || peek() == '-') {
      const double sign = text[at++] == '+' ? 1 : -1;
      const UnitValue term = parseProduct();
      if (term.powers != sum.powers) fail("adds " + describePowers(sum.powers) + " and " + describePowers(term.powers));
      sum.value += sign * term.value;
      sum.hasUnit = sum.hasUnit || term.hasUnit;
    }
    --depth;
    return sum;
  }

  UnitValue parseProduct() {
    UnitValue product = parseWithUnits();
    while (peek() == '*' || peek() == '/') {
      const int sign = text[at++] == '*' ? 1 : -1;
      const UnitValue factor = parseWithUnits();
      product = multiply(product, factor, sign);
    }
    return product;
  }

  static UnitValue multiply(const UnitValue& a, const UnitValue& b, int sign) {
    UnitValue result;
    result.value = sign > 0 ? a.value * b.value : a.value / b.value;
    for (std::size_t k = 0; k < 4; ++k) result.powers[k] = a.powers[k] + sign * b.powers[k];
    result.hasUnit = a.hasUnit || b.hasUnit;
    return result;
  }

  /// A signed factor and the units written behind it.
  UnitValue parseWithUnits() {
    bool negative = false;
    while (peek() == '-' || peek() == '+') negative ^= text[at++] == '-';
    UnitValue result = parsePower();
    if (negative) result.value = -result.value;
    while (nextIsUnit()) result = multiply(result, parsePower(), 1);
    skipOneOfUnit();
    return result;
  }

  bool nextIsUnit() {
    if (!startsName(peek())) return false;
    const std::size_t begin = at;
    const std::string_view name = takeName();
    if (!findUnit(name)) fail("unknown unit \"" + std::string(name) + '"');
    at = begin;
    return true;
  }

  /// "20 1/s": the 1 of the unit is no second number.
  void skipOneOfUnit() {
    if (peek() != '1') return;
    const std::size_t begin = at++;
    if (peek() != '/') at = begin;
  }

  UnitValue parsePower() {
    UnitValue base = parseAtom();
    if (!take('^')) return base;
    const bool negative = take('-');
    const UnitValue exponent = parseExponent();
    const double power = negative ? -exponent.value : exponent.value;
    UnitValue result = base;
    result.value = std::pow(base.value, power);
    for (int& p : result.powers) {
      if (p == 0) continue;
      if (power != std::floor(power) || std::abs(power) > 9) fail("a unit's power must be a whole number of at most 9");
      p *= static_cast<int>(power);
    }
    return result;
  }

  UnitValue parseExponent() {
    // A power isn't a second number of a plain quantity.
    const int before = std::exchange(numbersSeen, 0);
    const UnitValue exponent = parseAtom();
    numbersSeen = before;
    if (exponent.powers != number) fail("an exponent must be a plain number");
    return exponent;
  }

  UnitValue parseAtom() {
    const char c = peek();
    if ((c >= '0' && c <= '9') || c == '.') return parseNumber();
    if (startsName(c)) return parseName();
    if (lookup && take('(')) {
      const UnitValue inside = parseSum();
      if (!take(')')) fail("a closing bracket is missing");
      return inside;
    }
    fail(c ? "a number is missing before \"" + std::string(text.substr(at)) + '"' : std::string("a number is missing"));
  }

  UnitValue parseNumber() {
    UnitValue result;
    const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), result.value);
    if (error != std::errc()) fail("not a number");
    at = static_cast<std::size_t>(end - text.data());
    if (++numbersSeen > 1 && !lookup) fail("more than one number; write an expression as \"= ...\"");
    return result;
  }

  UnitValue parseName() {
    const std::string_view name = takeName();
    if (const Unit* unit = findUnit(name)) {
      if (numbersSeen == 0 && !lookup) fail("a number is missing before the unit");
      // A percentage is still a plain number.
      return {unit->factor, unit->powers, unit->powers != number};
    }
    if (!lookup) fail("unknown unit \"" + std::string(name) + '"');
    if (peek() == '(') return parseFunction(name);
    if (const UnitValue* found = (*lookup)(name)) return *found;
    fail("\"" + std::string(name) + "\" is neither a unit nor a parameter of the scene");
  }

  UnitValue parseFunction(std::string_view name) {
    take('(');
    UnitValue a = parseSum();
    if (name == "min" || name == "max") {
      if (!take(',')) fail(std::string(name) + " takes two values");
      const UnitValue b = parseSum();
      if (a.powers != b.powers) fail(std::string(name) + " compares different dimensions");
      a.value = name == "min" ? std::min(a.value, b.value) : std::max(a.value, b.value);
    } else if (name == "abs") {
      a.value = std::abs(a.value);
    } else if (name == "sqrt" || name == "cbrt") {
      const int root = name == "sqrt" ? 2 : 3;
      a.value = root == 2 ? std::sqrt(a.value) : std::cbrt(a.value);
      for (int& p : a.powers) {
        if (p % root != 0) fail("no such root of " + describePowers(a.powers));
        p /= root;
      }
    } else {
      fail("unknown function \"" + std::string(name) + "\"; there are sqrt, cbrt, abs, min, max");
    }
    if (!take(')')) fail("a closing bracket is missing");
    return a;
  }
};

}  // namespace

UnitValue parseQuantity(std::string_view text) { return Parser(text, nullptr).parse(); }

UnitValue evaluateExpression(std::string_view text, const UnitValueLookup& lookup) {
  return Parser(text, &lookup).parse();
}

double toSi(const UnitValue& quantity, Dimension expected) {
  const DimensionRow& wanted = row(expected);
  if (!quantity.hasUnit || quantity.powers == wanted.powers) return quantity.value;
  throw InputError("is " + withArticle(describePowers(quantity.powers)) + ", but " + withArticle(wanted.name) +
                   " is needed (units: " + std::string(wanted.accepted) + ")");
}

std::string_view dimensionName(Dimension dimension) { return row(dimension).name; }
std::string withArticle(std::string_view noun) {
  const bool vowel = !noun.empty() && std::string_view("aeiou").find(noun[0]) != std::string_view::npos;
  return (vowel ? "an " : "a ") + std::string(noun);
}
std::string_view siUnit(Dimension dimension) { return row(dimension).si; }
std::string_view acceptedUnits(Dimension dimension) { return row(dimension).accepted; }
bool isUnitName(std::string_view name) { return findUnit(name) != nullptr; }

}  // namespace granular
