#include "granular/core/units.h"

#include <gtest/gtest.h>

#include "granular/core/errors.h"

namespace granular {
namespace {

double read(std::string_view text, Dimension dimension) { return toSi(parseQuantity(text), dimension); }

std::string errorOf(std::string_view text, Dimension dimension) {
  try {
    read(text, dimension);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Units, EveryDimensionHasItsSiValue) {
  EXPECT_DOUBLE_EQ(read("25 mm", Dimension::length), 0.025);
  EXPECT_DOUBLE_EQ(read("25mm", Dimension::length), 0.025);
  EXPECT_DOUBLE_EQ(read("5 us", Dimension::time), 5e-6);
  EXPECT_DOUBLE_EQ(read("5 \u00b5s", Dimension::time), 5e-6);
  EXPECT_DOUBLE_EQ(read("2.5 g/cm^3", Dimension::density), 2500);
  EXPECT_DOUBLE_EQ(read("1e4 N/m", Dimension::stiffness), 1e4);
  EXPECT_DOUBLE_EQ(read("2 N/mm", Dimension::stiffness), 2000);
  EXPECT_DOUBLE_EQ(read("-3 cm/s", Dimension::velocity), -0.03);
  EXPECT_DOUBLE_EQ(read("9.81 m/s^2", Dimension::acceleration), 9.81);
  EXPECT_DOUBLE_EQ(read("30 deg", Dimension::angle), 0.5235987755982988);
  EXPECT_DOUBLE_EQ(read("60 rpm", Dimension::angularVelocity), 6.283185307179586);
  EXPECT_DOUBLE_EQ(read("2 kHz", Dimension::frequency), 2000);
  EXPECT_DOUBLE_EQ(read("20 1/s", Dimension::rate), 20);
  EXPECT_DOUBLE_EQ(read("60 1/min", Dimension::rate), 1);
  EXPECT_DOUBLE_EQ(read("3 mg", Dimension::mass), 3e-6);
  EXPECT_DOUBLE_EQ(read("4 nJ", Dimension::energy), 4e-9);
  EXPECT_DOUBLE_EQ(read("5 mN", Dimension::force), 5e-3);
  EXPECT_DOUBLE_EQ(read("70 GPa", Dimension::pressure), 7e10);
  EXPECT_DOUBLE_EQ(read("2 %", Dimension::none), 0.02);
}

TEST(Units, WrongUnitNamesBothDimensionsAndTheUnitsThatFit) {
  const std::string message = errorOf("25 kg", Dimension::length);
  EXPECT_NE(message.find("mass"), std::string::npos) << message;
  EXPECT_NE(message.find("length"), std::string::npos) << message;
  EXPECT_NE(message.find("mm"), std::string::npos) << message;
}

TEST(Units, MalformedQuantitiesAreRefusedWithTheirText) {
  for (const char* text :
       {"", "mm", "25 parsec", "1 2 mm", "3 mm +", "1..2 mm", "(3 mm)", "1e999 m", "5 mm)", "2 mm^"}) {
    const std::string message = errorOf(text, Dimension::length);
    EXPECT_NE(message, "no error") << text;
    EXPECT_NE(message.find(text), std::string::npos) << message;
  }
}

TEST(Units, ExpressionsFollowTheUsualPrecedence) {
  const UnitValue aspect{2, {0, 0, 0, 0}, false};
  const UnitValue width{3e-3, {1, 0, 0, 0}, true};
  const UnitValueLookup lookup = [&](std::string_view name) -> const UnitValue* {
    return name == "aspect" ? &aspect : name == "width" ? &width : nullptr;
  };
  const auto evaluate = [&](std::string_view text, Dimension d) { return toSi(evaluateExpression(text, lookup), d); };
  EXPECT_DOUBLE_EQ(evaluate("1.5 mm * aspect", Dimension::length), 3e-3);
  EXPECT_DOUBLE_EQ(evaluate("width / 2 + 1 mm", Dimension::length), 2.5e-3);
  EXPECT_DOUBLE_EQ(evaluate("10 mm / 2 s", Dimension::velocity), 5e-3);
  EXPECT_DOUBLE_EQ(evaluate("-(1 + 2*3)^2", Dimension::none), -49);
  EXPECT_DOUBLE_EQ(evaluate("cbrt(8 mm^3)", Dimension::length), 2e-3);
  EXPECT_DOUBLE_EQ(evaluate("max(aspect, 1/aspect)", Dimension::none), 2);
  EXPECT_DOUBLE_EQ(evaluate("aspect^0.5 * aspect^-0.5", Dimension::none), 1);
  // Without any unit the result is an SI number.
  EXPECT_DOUBLE_EQ(evaluate("0.0015 * aspect", Dimension::length), 3e-3);
  // A ratio of lengths is no length.
  EXPECT_THROW(evaluate("width / 1 mm", Dimension::length), InputError);
  EXPECT_THROW(evaluate("width + 1", Dimension::length), InputError);
  EXPECT_THROW(evaluate("height", Dimension::length), InputError);
  EXPECT_THROW(evaluate("sqrt(width)", Dimension::length), InputError);
  EXPECT_THROW(evaluate("1/0", Dimension::none), InputError);
  EXPECT_THROW(evaluate(std::string(1000, '(') + "1", Dimension::none), InputError);
}

}  // namespace
}  // namespace granular
