// The law's table, its parameters and their limits.
#include "granular/law/law.h"

#include <gtest/gtest.h>

#include "granular/core/errors.h"
#include "granular/law/materials.h"

namespace granular {
namespace {

std::string refusalOf(const ContactParameters& parameters) {
  try {
    prepareLaw(parameters);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(LawParameters, OutsideTheirRangeAreRefusedByNameAndLimit) {
  const double nan = std::nan("");
  ContactParameters p;
  EXPECT_EQ(refusalOf(p), "");
  p.restitution = 0;
  EXPECT_NE(refusalOf(p).find("restitution = 0.000000: must be > 0"), std::string::npos) << refusalOf(p);
  for (const double e : {1.5, -0.5, nan}) {
    p = {};
    p.restitutionT = e;
    EXPECT_NE(refusalOf(p).find("restitution_t"), std::string::npos) << e;
    EXPECT_NE(refusalOf(p).find("(0, 1]"), std::string::npos) << e;
  }
  for (const double k : {0.0, -1e4, nan, infinity}) {
    p = {};
    p.stiffness = k;
    EXPECT_NE(refusalOf(p).find("stiffness"), std::string::npos) << k;
  }
  for (const double friction : {-0.1, nan, infinity}) {
    p = {};
    p.friction = friction;
    EXPECT_NE(refusalOf(p).find("friction"), std::string::npos) << friction;
  }
}

TEST(LawParameters, DampingRatiosAreThoseOfTheClosedForms) {
  const double table[][3] = {
      {.9, .03352, .03427}, {.7, .11281, .12221}, {.5, .21545, .25528}, {.3, .35786, .49724}, {.1, .59116, 1.24319}};
  for (const auto& [e, attraction, cut] : table) {
    EXPECT_NEAR(dampingRatioFor(e, true), attraction, 5e-6);
    EXPECT_NEAR(dampingRatioFor(e, false), cut, 5e-6);
  }
  // zeta = 1 is e = exp(-2), and e = 1 has no damping.
  EXPECT_NEAR(dampingRatioFor(std::exp(-2), false), 1, 1e-12);
  EXPECT_EQ(dampingRatioFor(1, true), 0);
  EXPECT_EQ(dampingRatioFor(1, false), 0);
}

TEST(LawTable, FindsLawsByName) {
  EXPECT_EQ(lawFromName("linear"), LawKind::linear);
  EXPECT_EQ(lawName(LawKind::linear), "linear");
  EXPECT_THROW(lawFromName("hertz?"), InputError);
}

TEST(Materials, MixByTheStatedRule) {
  MaterialTable table;
  ContactParameters glass{1e4, .9, .6, .4}, wall{3e4, .4, .6, 0};
  EXPECT_EQ(table.add("glass", glass), 0);
  EXPECT_EQ(table.add("wall", wall), 1);
  EXPECT_EQ(table.constants(0, 0).parameters.stiffness, 1e4);
  EXPECT_DOUBLE_EQ(table.constants(0, 1).parameters.stiffness, 1.5e4);
  EXPECT_DOUBLE_EQ(table.constants(1, 0).parameters.restitution, .6);
  EXPECT_EQ(table.constants(1, 0).parameters.restitutionT, .6);
  EXPECT_EQ(table.constants(0, 1).parameters.friction, 0);

  // An explicit pair wins, in either order, and doesn't change what later materials mix from.
  table.setPair("wall", "glass", {2e4, .5, .5, .2});
  table.setPair("glass", "glass", {5e4, .5, .5, .2});
  EXPECT_EQ(table.constants(0, 1).parameters.friction, .2);
  EXPECT_EQ(table.constants(1, 0).parameters.stiffness, 2e4);
  EXPECT_EQ(table.add("steel", glass), 2);
  EXPECT_EQ(table.constants(0, 2).parameters.stiffness, 1e4);
  EXPECT_EQ(table.constants(0, 1).parameters.stiffness, 2e4);
}

TEST(Materials, RefuseUnknownAndDoubleNamesAndNameTheMaterialOfABadValue) {
  MaterialTable table;
  table.add("glass", {});
  EXPECT_THROW(table.add("glass", {}), InputError);
  EXPECT_THROW(table.add("", {}), InputError);
  EXPECT_THROW(table.find("steel"), InputError);
  EXPECT_THROW(table.setPair("glass", "steel", {}), InputError);
  try {
    table.add("mud", {1e4, 0, .5, .1});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("\"mud\""), std::string::npos);
  }
  EXPECT_EQ(table.count(), 1);
}

}  // namespace
}  // namespace granular
