#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/io/scene_file.h"
#include "granular/io/toml_characters.h"

namespace granular {
namespace {

namespace fs = std::filesystem;

const std::string vessel = R"(
[vessel]
kind = "cylinder"
radius = "25 mm"
)";
const std::string spheres = R"(
[[particles]]
shape = "sphere"
radius = "1.5 mm"
count = 100
)";

const std::string mixture = R"(
name = "mixture"
seed = 7
threads = 2
gravity = [0, 0, "-1.62 m/s^2"]
skip = ["broad_phase", "gjk"]
[vessel]
kind = "box"
size = ["50 mm", "40 mm", "1 m"]
material = "steel"
[[wall]]
kind = "plane"
point = [0, 0, 0.01]
normal = [0, 1, 1]
[[material]]
name = "glass"
density = "2.5 g/cm^3"
[[material]]
name = "steel"
density = 7850
[contact_default]
restitution = 0.9
[[contact]]
between = ["glass", "steel"]
friction = 0.3
[model]
tension = false
friction_limit = "push"
contact_mass = "local"
point_rule = "face_centroid"
slab = 0.5
[time]
step = "5 us"
max_time = "10 s"
[[particles]]
shape = "ellipsoid"
semi_axes = [1e-3, 1e-3, "3 mm"]
share = "40 %"
material = "glass"
size = {distribution = "lognormal", mean = 1, deviation = 0.2, min = 0.5, max = 2, by = "mass"}
[[particles]]
shape = "polyhedron"
vertices = [[0, 0, 0], ["1 mm", 0, 0], [0, "1 mm", 0], [0, 0, "1 mm"]]
share = 0.6
size = {distribution = "sieve", as = "diameter", sizes = ["1 mm", "2 mm", "4 mm"], passing = [0, 0.5, 1]}
[insertion]
kind = "rain"
count = 1000
rate = "500 1/s"
speed = "10 cm/s"
[settle]
kind = "sleep"
time = "2 ms"
[rest]
energy = 1e-7
max_time = 3
[output]
frames = "10 ms"
gap = "1 %"
[analysis]
alpha_step = "2 deg"
[limits]
on_trouble = "continue"
max_speed = "20 m/s"
)";

Scene parse(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return parseScene(text, fs::temp_directory_path() / "bed.toml", overrides);
}

std::string errorOf(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    parse(text, overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// Each part must be in the message.
void expectError(const std::string& text, const std::vector<std::string>& parts,
                 const std::vector<std::string>& overrides = {}) {
  const std::string message = errorOf(text, overrides);
  for (const std::string& part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << part << "\nnot in: " << message;
}

TEST(Scene, ShortestSceneGetsTheDocumentedDefaults) {
  const Scene scene = parse(vessel + spheres);
  EXPECT_EQ(scene.name, "bed");
  EXPECT_EQ(scene.seed, 1u);
  EXPECT_EQ(scene.gravity, Vec3(0, 0, -9.81));
  EXPECT_DOUBLE_EQ(scene.vessel.radius, 0.025);
  EXPECT_FALSE(scene.vessel.height.has_value());
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].density, 2500);
  EXPECT_EQ(scene.contactDefault.stiffness, 1e4);
  EXPECT_EQ(scene.contactDefault.friction, 0.1);
  EXPECT_EQ(scene.insertion.kind, InsertionSettings::Kind::batches);
  EXPECT_EQ(scene.insertion.batch.lo, 20);
  EXPECT_EQ(scene.insertion.batch.hi, 60);
  EXPECT_EQ(scene.skip, std::vector<std::string>{"all"});
  EXPECT_FALSE(scene.time.step.has_value());
  ASSERT_EQ(scene.particles.size(), 1u);
  EXPECT_EQ(scene.particles[0].count, 100);
  EXPECT_EQ(scene.particles[0].name, "sphere");
}

TEST(Scene, EverySectionIsRead) {
  const Scene scene = parse(mixture);
  EXPECT_EQ(scene.threads, 2);
  EXPECT_DOUBLE_EQ(scene.gravity.z(), -1.62);
  EXPECT_EQ(scene.vessel.size, Vec3(0.05, 0.04, 1));
  EXPECT_EQ(scene.materialIndex(scene.vessel.material), 1);
  EXPECT_EQ(scene.materialIndex(""), 0);
  EXPECT_EQ(scene.walls[0].normal, Vec3(0, 1, 1));
  EXPECT_EQ(scene.walls[0].name, "plane");
  EXPECT_DOUBLE_EQ(scene.materials[0].density, 2500);
  EXPECT_EQ(scene.contacts[0].parameters.restitution, 0.9) << "keys left out come from contact_default";
  EXPECT_EQ(scene.contacts[0].parameters.friction, 0.3);
  EXPECT_FALSE(scene.model.tension);
  EXPECT_EQ(scene.model.frictionLimit, ModelSettings::FrictionLimit::push);
  EXPECT_EQ(scene.model.contactMass, ModelSettings::ContactMass::local);
  EXPECT_EQ(scene.model.pointRule, "face_centroid");
  EXPECT_DOUBLE_EQ(*scene.time.step, 5e-6);
  EXPECT_EQ(scene.particles[0].semiAxes, Vec3(1e-3, 1e-3, 3e-3));
  EXPECT_DOUBLE_EQ(scene.particles[0].share, 0.4);
  EXPECT_EQ(scene.particles[0].size.distribution, SizeSettings::Distribution::lognormal);
  EXPECT_EQ(scene.particles[0].size.by, SizeSettings::By::mass);
  EXPECT_EQ(scene.particles[1].vertices[1], Vec3(1e-3, 0, 0));
  EXPECT_EQ(scene.particles[1].size.sizes, (std::vector<double>{1e-3, 2e-3, 4e-3}));
  EXPECT_EQ(scene.insertion.kind, InsertionSettings::Kind::rain);
  EXPECT_DOUBLE_EQ(scene.insertion.speed, 0.1);
  EXPECT_EQ(scene.settle.kind, SettleSettings::Kind::sleep);
  EXPECT_DOUBLE_EQ(*scene.output.frames, 0.01);
  EXPECT_NEAR(scene.analysis.alphaStep, pi / 90, 1e-15);
  EXPECT_EQ(scene.limits.onTrouble, LimitSettings::Action::proceed);
}

TEST(Scene, LettersBeyondAsciiArePartOfStringsAndCommentsOnly) {
  const auto find = [](std::string_view text) { return findStrayCharacter(text); };
  for (const char* fine :
       {"a = \"\xC2\xB5m\" # \xC2\xB0", "\xEF\xBB\xBF# mark\na = 1", "a = '\xC2\xB5\\'\nb = 1",
        "a = \"\"\"\n\xC2\xB5 \\\n x\xC2\xB5\"\"\" # \"", "a = '''\xC2\xB5\n\xC2\xB5'''", "a = \"\\\"\xC2\xB5\""})
    EXPECT_FALSE(find(fine)) << fine;
  EXPECT_EQ(find("\xC3\xA9 = 1"), 0u);
  EXPECT_EQ(find("a = 1 \xC2\xB5"), 6u);
  EXPECT_EQ(find("a = \"\" \xC2\xB5"), 7u);
  EXPECT_EQ(find("# \xC2\xB5\n\xEF\xBB\xB9 = 1"), 5u);
  EXPECT_EQ(find("a = \"\"\"x\\ \n \xC2\xB5\"\"\""), 12u);
  EXPECT_EQ(find("a = \"open\n\xC2\xB5"), 10u);
  try {
    parseScene(
        "seed = 1\ngr\xC3\xB6\xC3\x9F"
        "e = 2\n",
        "here.toml", {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("here.toml:2:3: "), std::string::npos) << error.what();
  }
}

TEST(Scene, UnknownKeyIsNamedWithItsPlaceAndTheNearestKnownOne) {
  expectError("\n[vessel]\nkind = \"cylinder\"\nraduis = 1\nradius = 0.025\n" + spheres,
              {"bed.toml:4:1", "vessel.raduis", "= 1", "unknown key", "did you mean \"radius\"?"});
  expectError(vessel + spheres + "[outptu]\nstl = true\n", {"outptu", "did you mean \"output\"?"});
}

TEST(Scene, KeyOfAnotherKindIsRefused) {
  expectError(vessel + "size = [1, 1, 1]\n" + spheres,
              {"vessel.size", "isn't used by kind \"cylinder\"", "box,periodic"});
  expectError(vessel + spheres + "height = 1\n", {"particles.0.height", "isn't used by kind \"sphere\"", "cylinder"});
}

TEST(Scene, LawOfHertzReadsElasticMaterials) {
  const std::string rice = R"(
[model]
law = "hertz_mindlin"
[[material]]
name = "rice"
young_modulus = "183 MPa"
poisson_ratio = 0.2
[[material]]
name = "steel"
young_modulus = inf
poisson_ratio = 0.3
[contact_default]
restitution = 0.5
[[contact]]
between = ["rice", "steel"]
friction = 0.2
[time]
overlap = 0.05
)";
  const Scene scene = parse(vessel + spheres + rice);
  EXPECT_DOUBLE_EQ(scene.materials[0].elasticity.young, 183e6);
  EXPECT_DOUBLE_EQ(scene.materials[0].elasticity.poisson, 0.2);
  EXPECT_EQ(scene.materials[1].elasticity.young, infinity);
  EXPECT_EQ(scene.contacts[0].parameters.restitution, 0.5);
  EXPECT_EQ(scene.time.overlap, 0.05);

  const Scene paper = parse(vessel + spheres +
                            "[model]\nlaw = \"hertz\"\n[[material]]\nname = \"rice\"\nyoung_modulus = \"183 MPa\"\n"
                            "poisson_ratio = 0.2\n[contact_default]\ndamping_normal = \"100 1/s\"\n");
  EXPECT_EQ(paper.contactDefault.dampingRateN, 100);
}

TEST(Scene, KeysOfOtherLawsAreRefused) {
  const std::string stone = "[[material]]\nname = \"stone\"\n";
  const std::string elastic = stone + "young_modulus = 1e9\npoisson_ratio = 0.2\n";
  const std::string mindlin = "[model]\nlaw = \"hertz_mindlin\"\n", hertz = "[model]\nlaw = \"hertz\"\n";
  expectError(vessel + spheres + elastic, {"material.0.young_modulus", "isn't used by kind \"linear\"", "hertz"});
  expectError(vessel + spheres + mindlin + elastic + "[contact_default]\nstiffness = 1e4\n",
              {"contact_default.stiffness", "isn't used by kind \"hertz_mindlin\"", "linear"});
  expectError(vessel + spheres + hertz + elastic + "[contact_default]\nrestitution = 0.5\n",
              {"contact_default.restitution", "isn't used by kind \"hertz\""});
  expectError(vessel + spheres + mindlin + elastic + "[contact_default]\ndamping_normal = 100\n",
              {"contact_default.damping_normal", "belongs to: hertz"});
  expectError(vessel + spheres + "[time]\noverlap = 0.1\n", {"time.overlap", "hertz,hertz_mindlin"});
  expectError(vessel + spheres + mindlin + stone, {"material.0.young_modulus", "is missing"});
  expectError(vessel + spheres + mindlin, {"model.law", "hertz_mindlin", "young_modulus", "[[material]]"});
  expectError(vessel + spheres + mindlin + stone + "young_modulus = -1\npoisson_ratio = 0.6\n",
              {"material.0.young_modulus", "> 0 Pa", "material.0.poisson_ratio", "> -1 and <= 0.5"});
  expectError(vessel + spheres + mindlin + stone + "young_modulus = inf\npoisson_ratio = 0.3\n",
              {"material.0.young_modulus", "only walls can be rigid"});
}

TEST(Scene, MissingKeyIsNamedWithItsSection) {
  expectError("[vessel]\nkind = \"cylinder\"\n" + spheres, {"bed.toml:1:1", "vessel.radius", "is missing"});
  expectError(spheres, {"vessel", "is missing"});
  expectError(vessel, {"particles", "is missing"});
  expectError(vessel + "[[particles]]\nradius = 1\n", {"particles.0.shape", "is missing"});
}

TEST(Scene, WrongUnitNamesKeyValueDimensionAndUnits) {
  expectError("[vessel]\nkind = \"cylinder\"\nradius = \"25 kg\"\n" + spheres,
              {"bed.toml:3:10", "vessel.radius", "25 kg", "is a mass", "length", "m, cm, mm"});
  expectError("[vessel]\nkind = \"cylinder\"\nradius = \"25\"\n" + spheres, {"vessel.radius", "has no unit", "length"});
  expectError("[vessel]\nkind = \"cylinder\"\nradius = \"25 furlong\"\n" + spheres, {"unknown unit \"furlong\"", "mm"});
}

TEST(Scene, ValueOfTheWrongKindIsRefused) {
  expectError("[vessel]\nkind = \"cylinder\"\nradius = true\n" + spheres,
              {"vessel.radius", "true", "must be a length"});
  expectError("seed = 1.5\n" + vessel + spheres, {"seed", "1.5", "whole number"});
  expectError(vessel + spheres + "[output]\nstl = 1\n", {"output.stl", "true or false"});
  expectError("gravity = 9.81\n" + vessel + spheres, {"gravity", "[x, y, z]"});
  expectError("name = 3\n" + vessel + spheres, {"name", "text in quotes"});
  expectError("vessel = 1\n" + spheres, {"vessel", "must be a table"});
  expectError(vessel + "[particles]\nshape = \"sphere\"\n", {"particles", "[[particles]]"});
  expectError(vessel + spheres + "[model]\npoint_rule = \"patches\"\n",
              {"model.point_rule", "patches", "witness", "did you mean \"patch\"?"});
  expectError("skip = [\"gkj\"]\n" + vessel + spheres, {"skip.0", "gkj", "did you mean \"gjk\"?"});
}

TEST(Scene, ValueOutOfRangeNamesTheRange) {
  expectError("[vessel]\nkind = \"cylinder\"\nradius = \"-25 mm\"\n" + spheres,
              {"vessel.radius", "-25 mm", "must be > 0 m"});
  expectError(vessel + "[[particles]]\nshape = \"sphere\"\nradius = -1e-3\ncount = 5\n",
              {"particles.0.radius", "> 0 m"});
  expectError(vessel + spheres + "[[material]]\nname = \"air\"\ndensity = 0\n",
              {"material.0.density", "= 0", "> 0 kg/m^3"});
  expectError(vessel + spheres + "[contact_default]\nrestitution = 0\n",
              {"contact_default.restitution", "> 0 and <= 1"});
  expectError("[vessel]\nkind = \"cylinder\"\nradius = inf\n" + spheres, {"vessel.radius", "inf", "> 0 m"});
  expectError("gravity = [0, 0, -inf]\n" + vessel + spheres, {"gravity.2", "finite"});
  expectError(vessel + spheres + "[contact_default]\nfriction = nan\n", {"contact_default.friction", "nan"});
  expectError(vessel + spheres + "[time]\nfraction = 2\n", {"time.fraction", "> 0 and <= 1"});
  expectError(vessel + "[[particles]]\nshape = \"sphere\"\nradius = 1e-3\ncount = 0\n", {"particles.0.count", ">= 1"});
}

TEST(Scene, ParticleLargerThanTheVesselIsRefused) {
  expectError(vessel + "[[particles]]\nshape = \"cuboid\"\nhalf_lengths = [20e-3, 20e-3, 1e-3]\ncount = 5\n",
              {"bed.toml", "particles.0", "larger than the vessel", "0.025"});
}

TEST(Scene, MissingFileIsNamed) {
  expectError(vessel + "[[particles]]\nshape = \"mesh\"\nfiles = [\"nothing.obj\"]\nunit = \"kg\"\ncount = 1\n",
              {"particles.0.unit", "is a mass", "but a length"});
  expectError(vessel + "[[particles]]\nshape = \"mesh\"\nfiles = [\"nothing.obj\"]\nunit = \"mm\"\ncount = 1\n",
              {"particles.0.files.0", "there is no such file", "nothing.obj"});
  EXPECT_THROW(readScene("/nonexistent/scene.toml"), InputError);
}

TEST(Scene, ContradictionsBetweenKeysAreRefused) {
  expectError(vessel + spheres + "material = \"gold\"\n", {"particles.0.material", "gold", "the scene has: default"});
  expectError(vessel + spheres + "[[contact]]\nbetween = [\"default\"]\n", {"contact.0.between", "two materials"});
  expectError(vessel + spheres + "share = 0.5\n", {"particles.0", "either count or share"});
  expectError(vessel + spheres + "[insertion]\ncount = 5\n", {"insertion.count", "is 5", "add up to 100"});
  expectError(vessel + spheres + "size = {distribution = \"uniform\", min = 2, max = 1}\n", {"min (2)", "max (1)"});
  expectError(vessel + spheres + "size = {distribution = \"sieve\", sizes = [1, 2], passing = [0.1, 1]}\n",
              {"particles.0.size.passing", "from 0"});
  expectError(vessel + spheres + "[[wall]]\nkind = \"plane\"\nnormal = [0, 0, 0]\n", {"wall.0.normal", "zero"});
  expectError("skip = [\"all\", \"gjk\"]\n" + vessel + spheres, {"skip", "stands alone"});
  expectError("gravity = [0, 0, 0]\n" + vessel + spheres, {"gravity", "zero"});
}

TEST(Scene, EveryProblemIsListedAtOnce) {
  const std::string message =
      errorOf("sed = 1\n[vessel]\nkind = \"cylinder\"\nradius = -1\n" + spheres + "colour = 3\n");
  EXPECT_NE(message.find("sed"), std::string::npos);
  EXPECT_NE(message.find("vessel.radius"), std::string::npos);
  EXPECT_NE(message.find("particles.0.colour"), std::string::npos);
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 2);
}

TEST(Scene, BrokenTomlIsNamedWithLine) {
  expectError("\n[=\n", {"bed.toml:2:2", "not valid TOML"});
  expectError("[vessel\nkind = 1\n", {"bed.toml:1:", "not valid TOML"});
}

TEST(Scene, RandomlyDamagedScenesAreReadOrRefused) {
  Random random(3);
  const std::string letters = "=[]{}\"'.,-_ \n\\#0e9mxA%(^";
  int refused = 0;
  for (int k = 0; k < 3000; ++k) {
    std::string text = mixture;
    for (std::uint64_t n = 1 + random.below(3); n > 0; --n) {
      const std::size_t at = random.below(text.size());
      if (random.below(3) == 0)
        text.erase(at, 1 + random.below(4));
      else
        text[at] = letters[random.below(letters.size())];
    }
    try {
      parse(text);
    } catch (const InputError& error) {
      ++refused;
      EXPECT_NE(std::string(error.what()).find("bed.toml"), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(refused, 2000);
}

TEST(Scene, OverridesReplaceValuesBeforeTheyAreChecked) {
  const Scene scene = parse(vessel + spheres, {"particles.0.count=7", "vessel.radius=30 mm", "seed=9",
                                               "output.stl=false", "gravity=[0,0,-1]", "settle.kind=freeze"});
  EXPECT_EQ(scene.particles[0].count, 7);
  EXPECT_DOUBLE_EQ(scene.vessel.radius, 0.03);
  EXPECT_EQ(scene.seed, 9u);
  EXPECT_FALSE(scene.output.stl);
  EXPECT_EQ(scene.gravity.z(), -1);
  EXPECT_EQ(scene.settle.kind, SettleSettings::Kind::freeze);
}

TEST(Scene, BadOverridesAreNamedAsGiven) {
  expectError(vessel + spheres, {"--set vessel.raduis=1", "unknown key"}, {"vessel.raduis=1"});
  expectError(vessel + spheres, {"--set vessel.radius=-1 mm", "must be > 0 m"}, {"vessel.radius=-1 mm"});
  expectError(vessel + spheres, {"--set particles.3.count=1", "there are 1"}, {"particles.3.count=1"});
  expectError(vessel + spheres, {"--set seed", "key.path=value"}, {"seed"});
  expectError(vessel + spheres, {"--set vessel.kind.x=1", "nothing lies below"}, {"vessel.kind.x=1"});
  expectError(vessel + spheres, {"--set aspect_ratio=2", "unknown key"}, {"aspect_ratio=2"});
}

TEST(Scene, ParametersFeedExpressionsAndAreSetByName) {
  const std::string text =
      "[parameters]\naspect_ratio = 1.0\nwidth = \"3 mm\"\ndepth = \"= width * aspect_ratio\"\n" + vessel +
      "[[particles]]\nshape = \"cuboid\"\nhalf_lengths = [\"= width/2\", \"= width/2\", \"= depth/2\"]\n"
      "count = \"= 10 * aspect_ratio\"\n";
  EXPECT_EQ(parse(text).particles[0].halfLengths, Vec3(1.5e-3, 1.5e-3, 1.5e-3));
  const Scene scene = parse(text, {"aspect_ratio=2"});
  EXPECT_EQ(scene.particles[0].halfLengths, Vec3(1.5e-3, 1.5e-3, 3e-3));
  EXPECT_EQ(scene.particles[0].count, 20);
}

TEST(Scene, ParametersThatCannotWorkAreRefused) {
  expectError("[parameters]\nspare = 1\n" + vessel + spheres, {"bed.toml:2:1", "parameters.spare", "isn't used"});
  expectError("[parameters]\nmm = 1\n" + vessel + spheres, {"parameters.mm", "name of a unit"});
  expectError("[parameters]\na = \"= b\"\nb = 1\n" + vessel + spheres, {"parameters.a", "\"b\" is neither"});
}

TEST(Scene, EverySceneOfTheDemosIsRight) {
  const fs::path folder = fs::path(GRANULAR_SOURCE_DIR) / "demos/scenes";
  int scenes = 0;
  if (fs::exists(folder))
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().extension() == ".toml") {
        ++scenes;
        EXPECT_NO_THROW(readScene(entry.path())) << entry.path();
      }
  if (scenes == 0) GTEST_SKIP() << "no scenes in " << folder;
}

TEST(Scene, ReferenceNamesEverySectionAndKey) {
  std::ostringstream out;
  printSceneReference(out);
  for (const char* word : {"[vessel]", "[[particles]]", "[[wall]]", "[contact_default]", "half_lengths", "on_trouble",
                           "checkpoint_every", "[particles.size]", "passing", "vertex_count", "> 0 m", "face_centroid"})
    EXPECT_NE(out.str().find(word), std::string::npos) << word;
}

}  // namespace
}  // namespace granular
