// Every contact-point rule, every law and every family of shapes goes on from a checkpoint to the same bits; so does a
// bed large enough to be shared out among threads.
#include "run/resume_fixture.h"

namespace granular {
namespace {

struct SweepCase {
  std::string name;
  std::string particles;
  std::vector<std::string> overrides;
  bool elastic = false;  ///< materials with a Young's modulus instead of a stiffness
};

void PrintTo(const SweepCase& c, std::ostream* out) { *out << c.name; }

std::string caseName(const ::testing::TestParamInfo<SweepCase>& info) { return info.param.name; }

/// As commonText, for laws of Hertz: as soft.
const std::string elasticText = R"(
[[material]]
name = "soft"
young_modulus = "2 MPa"
poisson_ratio = 0.3
[output]
picture = false
plots = false
stl = false
glb = false
)";

class ResumeSweep : public ResumeTest, public ::testing::WithParamInterface<SweepCase> {};

TEST_P(ResumeSweep, EndsInTheSameBits) {
  const SweepCase& c = GetParam();
  // The stop lies amid the first impacts.
  expectSameAt(0.032, 0.0291, narrowBox + (c.elastic ? elasticText : commonText) + c.particles + few, c.overrides);
}

std::vector<SweepCase> everyRule() {
  std::vector<SweepCase> cases;
  for (int rule = 0; rule <= static_cast<int>(PointRule::foundation); ++rule) {
    const std::string name(pointRuleName(static_cast<PointRule>(rule)));
    cases.push_back({name, mixture, {"model.point_rule=" + name}});
  }
  return cases;
}

std::vector<SweepCase> everyLaw() {
  std::vector<SweepCase> cases;
  for (int law = 0; law <= static_cast<int>(LawKind::hertzMindlin); ++law) {
    const std::string name(lawName(static_cast<LawKind>(law)));
    cases.push_back({name, mixture, {"model.law=" + name, "model.point_rule=witness"}, name.starts_with("hertz")});
  }
  return cases;
}

std::vector<SweepCase> everyShape() {
  const auto group = [](const std::string& shape, const std::string& keys) {
    return SweepCase{shape, "[[particles]]\nshape = \"" + shape + "\"\n" + keys, {}};
  };
  const std::string pebble = std::string(GRANULAR_SOURCE_DIR) + "/meshes/pebble_mm.stl";
  return {
      group("sphere", "radius = \"1.5 mm\"\n"),
      group("ellipsoid", "semi_axes = [\"1 mm\", \"1.3 mm\", \"2 mm\"]\n"),
      group("cylinder", "radius = \"1.2 mm\"\nheight = \"2.6 mm\"\n"),
      group("cone", "radius = \"1.5 mm\"\nheight = \"3 mm\"\n"),
      group("cuboid", "half_lengths = [\"1.2 mm\", \"1.2 mm\", \"1.5 mm\"]\n"),
      group("polyhedron",
            "vertices = [[\"2 mm\", 0, 0], [\"-2 mm\", 0, 0], [0, \"2 mm\", 0], [0, \"-2 mm\", 0], "
            "[0, 0, \"2 mm\"], [0, 0, \"-1 mm\"]]\n"),
      group("mesh", "files = [\"" + pebble + "\"]\nunit = \"mm\"\nextent = [\"3 mm\", \"4 mm\"]\nmax_vertices = 30\n"),
      group("sand", "radius = \"1.5 mm\"\n"),
      group("woodchip", "length = [\"3 mm\", \"4 mm\"]\n"),
      group("clump",
            "radii = [\"1 mm\", \"1.2 mm\", \"0.8 mm\"]\n"
            "centres = [[0, 0, 0], [\"1.5 mm\", 0, 0], [\"2 mm\", \"1.4 mm\", 0]]\n"),
  };
}

INSTANTIATE_TEST_SUITE_P(Rules, ResumeSweep, ::testing::ValuesIn(everyRule()), caseName);
INSTANTIATE_TEST_SUITE_P(Laws, ResumeSweep, ::testing::ValuesIn(everyLaw()), caseName);
INSTANTIATE_TEST_SUITE_P(Shapes, ResumeSweep, ::testing::ValuesIn(everyShape()), caseName);

using ResumeSleepers = ResumeTest;

TEST_F(ResumeSleepers, KeepWhatTheStepBoundOfTheirContactsReads) {
  // All asleep at the stop, so that the bound of the contacts is that of the contacts kept.
  const std::string cubes = "[[particles]]\nshape = \"cuboid\"\nhalf_lengths = [\"1.2 mm\", \"1.2 mm\", \"1.5 mm\"]\n";
  const std::string poses = "[insertion]\nkind = \"poses\"\nfile = \"poses.txt\"\n";
  for (const bool elastic : {false, true}) {
    // Towers of two cuboids; four balls on the floor, where Hertz's law leaves nothing that rocks.
    std::ofstream(folder / "poses.txt") << "-3e-3 0 1.5e-3 1 0 0 0\n3e-3 1e-3 1.5e-3 1 0 0 0\n"
                                        << (elastic ? "-3e-3 5e-3 1.5e-3 1 0 0 0\n3e-3 5e-3 1.5e-3 1 0 0 0\n"
                                                    : "-3e-3 0 4.5e-3 1 0 0 0\n3.1e-3 1e-3 4.5e-3 1 0 0 0\n");
    const std::string scene =
        narrowBox + (elastic ? elasticText + spheres : commonText + cubes) + poses + settle("sleep");
    // Never at rest for long enough, so that nothing wakes them.
    std::vector<std::string> model{"rest.time=100", "settle.energy=0.01", "settle.time=0.005"};
    model.push_back(elastic ? "model.law=hertz_mindlin" : "model.point_rule=foundation");
    if (elastic) model.push_back("model.point_rule=witness");
    expectSameAt(0.1, 0.09, scene, model);
    const PackingRun end = PackingRun::resumed(folder / "parts");
    const auto& states = end.world().bodies.state;
    EXPECT_EQ(std::count(states.begin(), states.end(), BodyState::asleep), 4) << elastic;
  }
}

using ResumeShared = ResumeTest;

TEST_F(ResumeShared, ABedThatThreadsShareOutEndsInTheSameBits) {
  // Above the numbers of bodies and of pairs from which on threads are used (world/stages.h).
  constexpr int side = 17;
  {
    std::ofstream poses(folder / "poses.txt");
    for (int k = 0; k < side * side * side; ++k) {
      const int column = k % side - side / 2, row = k / side % side - side / 2, layer = k / side / side;
      const double at[] = {3.01e-3 * column, 3.01e-3 * row, 1.5e-3 + 3.01e-3 * layer};
      poses << at[0] << ' ' << at[1] << ' ' << at[2] << " 1 0 0 0\n";
    }
  }
  const std::string vessel = "[vessel]\nkind = \"box\"\nsize = [\"52 mm\", \"52 mm\", \"60 mm\"]\n";
  const std::string poses = "[insertion]\nkind = \"poses\"\nfile = \"poses.txt\"\n";
  // Tilted, so that springs stretch in every direction.
  expectSameAt(0.004, 0.0025, "gravity = [3, 1, -9]\n" + vessel + commonText + spheres + poses);
}

}  // namespace
}  // namespace granular
