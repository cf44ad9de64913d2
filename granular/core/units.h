// Quantities as people write them: "25 mm", "2.5 g/cm^3", "30 deg", "2 %", and small expressions such as
// "1.5 mm * aspect_ratio". Every value carries its dimension, so that a mass can't stand where a length is meant.
// Inside the program everything is SI.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>

namespace granular {

/// What a number in a scene means. `rate`: events per second; `none`: a plain number or percentage.
enum class Dimension : unsigned char {
  none,
  length,
  area,
  volume,
  time,
  mass,
  density,
  stiffness,
  velocity,
  acceleration,
  angle,
  angularVelocity,
  frequency,
  rate,
  force,
  energy,
  pressure
};

/// A number in SI units with the powers of m, kg, s and rad it carries.
struct UnitValue {
  double value = 0;
  std::array<int, 4> powers = {0, 0, 0, 0};
  /// A unit was written somewhere; a result without one is taken as an SI number.
  bool hasUnit = false;
};

/// Finds a named value for an expression; nullptr: no such name.
using UnitValueLookup = std::function<const UnitValue*(std::string_view name)>;

/// A number followed by a unit ("25 mm", "1e4 N/m", "20 1/s", "2 %"). Throws InputError naming the text and what is
/// wrong.
UnitValue parseQuantity(std::string_view text);

/// An expression of numbers, units and names with + - * / ^ ( ) and sqrt, cbrt, abs, min, max. A unit binds to the
/// number before it more tightly than * and /: "10 mm / 2 s" is 5 mm/s. Throws InputError.
UnitValue evaluateExpression(std::string_view text, const UnitValueLookup& lookup);

/// The SI value, or InputError naming the expected dimension and its units when the quantity is something else.
double toSi(const UnitValue& quantity, Dimension expected);

/// "length", "density", ...
std::string_view dimensionName(Dimension dimension);
/// "a length", "an angle".
std::string withArticle(std::string_view noun);
/// The SI unit: "m", "kg/m^3", ...; empty for `none`.
std::string_view siUnit(Dimension dimension);
/// Units for messages: "m, cm, mm, um, nm, km".
std::string_view acceptedUnits(Dimension dimension);
/// True if a unit has this name, so that nothing else may.
bool isUnitName(std::string_view name);

}  // namespace granular
