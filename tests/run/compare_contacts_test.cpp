// The comparison of contacts: its scenes against their theory, and its table on disk.
#include <gtest/gtest.h>

#include <fstream>

#include "granular/core/errors.h"
#include "granular/run/comparison_table.h"
#include "granular/run/moving_scenes.h"
#include "granular/run/standing_scenes.h"
#include "io/scratch_folder.h"

namespace granular {
namespace {

ComparisonCase makeCase(std::string_view scene, PointRule rule, double softness, double unit = 3e-3) {
  ComparisonCase each{&comparisonSceneFromName(scene), &comparisonEngines()[1], unit, {}};
  each.settings.rule.rule = rule;
  each.settings.softness = softness;
  return each;
}

TEST(DryArch, OfManyVoussoirsIsAsThinAsMilankovitchs) {
  // Milankovitch 1907: .1075 of the radius of the centre line.
  EXPECT_NEAR(thinnestArch(2000), 0.1075, 1e-4);
  // Hinges form at joints alone: fewer joints make an arch safer.
  double last = thinnestArch(2000);
  for (const int voussoirs : {200, 48, 16, 8}) {
    EXPECT_LE(thinnestArch(voussoirs), last);
    last = thinnestArch(voussoirs);
  }
}

TEST(ContactScenes, BlockOnASlopeRestsBelowTheFrictionAngle) {
  for (const PointRule rule : {PointRule::stiffPatch, PointRule::foundation}) {
    const ComparisonResult result = runCase(makeCase("tilted_0.98", rule, 1e-4));
    EXPECT_TRUE(result.verdict.asTheory) << pointRuleName(rule);
    // It yields by its own softness, and by its slip while it bounces at the start.
    EXPECT_LT(*result.verdict.error, 5e-3) << pointRuleName(rule);
  }
}

TEST(ContactScenes, BlockOnASlopeSlidesAboveItWithTheExactAcceleration) {
  for (const PointRule rule : {PointRule::stiffPatch, PointRule::foundation}) {
    const ComparisonResult result = runCase(makeCase("tilted_1.02", rule, 1e-4));
    // What the start leaves has decayed to round-off by a quarter of the time.
    EXPECT_LT(*result.verdict.error, 1e-8) << pointRuleName(rule);
  }
}

TEST(ContactScenes, BlockUnderPatchRestsWhereDampingOutrunsItsFlutter) {
  // k_n times the deepest overlap, at the centre of pressure, has no potential: sinking and rocking feed each other
  // when the load is off the middle (docs/contacts.md). At e = .05 the dashpot takes more than that.
  SceneSetup setup = comparisonSceneFromName("tilted_0.98").build(3e-3);
  setup.restitution = 0.05;
  EngineSettings settings;
  settings.rule.rule = PointRule::patch;
  settings.softness = 1e-4;
  EXPECT_TRUE(judgeRestingBlock(setup, runGranularScene(setup, settings).recording).asTheory);
}

TEST(ContactScenes, SixBlocksStandAtLessThanTheHarmonicOverhangAndFallAtMore) {
  const ComparisonResult less = runCase(makeCase("overhang_0.98", PointRule::stiffPatch, 1e-4));
  EXPECT_TRUE(less.verdict.asTheory);
  EXPECT_LT(*less.verdict.error, 0.02);
  EXPECT_TRUE(runCase(makeCase("overhang_1.02", PointRule::stiffPatch, 1e-4)).verdict.asTheory);
}

/// A corner drop with some sixty steps in the contact: without a dashpot the stable step is a fifth of the contact.
ComparisonCase makeDrop(PointRule rule, double softness) {
  ComparisonCase each = makeCase("corner_drop", rule, softness);
  each.settings.fraction = 0.05;
  return each;
}

TEST(ContactScenes, CubeOnItsCornerReboundsAsARigidBodyInTheStiffLimit) {
  // The contact takes a time that goes with the root of the softness, and the cube turns meanwhile.
  for (const PointRule rule : {PointRule::patch, PointRule::stiffPatch}) {
    const double soft = *runCase(makeDrop(rule, 1e-4)).verdict.error;
    const double stiff = *runCase(makeDrop(rule, 1e-6)).verdict.error;
    EXPECT_LT(soft, 0.05) << pointRuleName(rule);
    EXPECT_NEAR(soft / stiff, 10, 1) << pointRuleName(rule);
  }
}

TEST(ContactScenes, CubeOnItsCornerKeepsEnergyAndWhatNoForceChanges) {
  const ComparisonCase each = makeDrop(PointRule::stiffPatch, 1e-4);
  const ComparisonResult result = runCase(each);
  const SceneSetup setup = each.scene->build(each.unit);
  const auto energyOf = [&](const Snapshot& now) {
    const BodyMotion& body = now.bodies[0];
    const double inertia = setup.unit * setup.unit / 6;
    return 0.5 * (body.velocity.squaredNorm() + inertia * body.spin.squaredNorm()) + setup.gravity * body.pose.x.z();
  };
  // In flight again, .3 sqrt(a/g) after the impact.
  const auto& snapshots = result.run.recording.snapshots;
  const auto after = std::find_if(snapshots.begin(), snapshots.end(),
                                  [&](const Snapshot& now) { return now.time > 1.7 * setup.timeUnit(); });
  const BodyMotion& body = after->bodies[0];
  const double speed = std::sqrt(2 * setup.gravity * setup.unit);
  EXPECT_GT(body.spin.norm() * setup.timeUnit(), 1);
  // Without friction nothing pushes sideways, and nothing turns about the vertical.
  EXPECT_LT(body.velocity.head<2>().norm(), 1e-12 * speed);
  EXPECT_LT(std::abs(body.spin.z()), 1e-9 * body.spin.norm());
  // (w dt)^2 = 2.5e-3 at .05 of the bound, of which the ends of the contact leave some part.
  EXPECT_NEAR(energyOf(*after) - energyOf(snapshots.front()), 0, 2.5e-3 * 0.5 * speed * speed);
}

TEST(ContactScenes, AreTheSameProblemAtEverySize) {
  const double small = *runCase(makeCase("corner_drop", PointRule::patch, 1e-4)).verdict.error;
  const double large = *runCase(makeCase("corner_drop", PointRule::patch, 1e-4, 1)).verdict.error;
  EXPECT_NEAR(small / large, 1, 1e-6);
}

TEST(BulletScenes, StandAtOneMetre) {
  ComparisonCase each{&comparisonSceneFromName("brick_wall"), &comparisonEngines()[0], 1, {}};
  EXPECT_TRUE(runCase(each).verdict.asTheory);
}

TEST(BulletScenes, LetAnArchThatIsTooThinFall) {
  ComparisonCase each{&comparisonSceneFromName("arch_0.9"), &comparisonEngines()[0], 1, {}};
  EXPECT_TRUE(runCase(each).verdict.asTheory);
}

class ContactTable : public ScratchFolder {};

TEST_F(ContactTable, GoesOnWhereItWasStopped) {
  const ComparisonCase first = makeCase("corner_drop", PointRule::witness, 1e-4);
  const ComparisonCase second = makeCase("corner_drop", PointRule::patch, 1e-4);
  {
    ComparisonTable table(folder);
    EXPECT_FALSE(table.has(first));
    table.add(first, runCase(first));
    EXPECT_TRUE(table.has(first));
  }
  ComparisonTable table(folder);
  EXPECT_TRUE(table.has(first));
  EXPECT_FALSE(table.has(second));
  const ComparisonResult result = runCase(second);
  table.add(second, result);
  table.add(second, result);
  EXPECT_EQ(table.size(), 2u);
  // A line of names and one for each case.
  std::ifstream csv(folder / "contacts.csv");
  int lines = 0;
  for (std::string line; std::getline(csv, line);) ++lines;
  EXPECT_EQ(lines, 3);
}

TEST_F(ContactTable, RefusesAFileThatIsNone) {
  std::ofstream(folder / "contacts.json") << "{\"rows\": [{\"scene\": \"tower\"}]}";
  EXPECT_THROW(ComparisonTable{folder}, InputError);
  std::ofstream(folder / "contacts.json") << "half a fi";
  EXPECT_THROW(ComparisonTable{folder}, InputError);
}

TEST(ContactCases, AreChosenBySceneEngineAndRule) {
  ComparisonChoice choice;
  choice.scenes = {"tower"};
  choice.engines = {"granular"};
  choice.rules = {"patch"};
  choice.softnesses = {1e-4};
  EXPECT_EQ(listCases(choice).size(), 2u);  // at both sizes
  choice.engines = {"bullet"};
  EXPECT_EQ(listCases(choice).size(), 18u);  // three sizes and units, three steps, two counts of iterations
  std::vector<std::string> keys;
  for (const ComparisonCase& each : listCases({})) keys.push_back(each.key());
  std::sort(keys.begin(), keys.end());
  EXPECT_EQ(std::adjacent_find(keys.begin(), keys.end()), keys.end());
}

TEST(ContactCases, RefuseWhatTheyDontKnow) {
  const auto with = [](auto change) {
    ComparisonChoice choice;
    change(choice);
    return choice;
  };
  EXPECT_THROW(listCases(with([](auto& c) { c.scenes = {"castle"}; })), InputError);
  EXPECT_THROW(listCases(with([](auto& c) { c.engines = {"havok"}; })), InputError);
  EXPECT_THROW(listCases(with([](auto& c) { c.rules = {"corner"}; })), InputError);
  EXPECT_THROW(listCases(with([](auto& c) { c.units = {-1}; })), InputError);
  EXPECT_THROW(listCases(with([](auto& c) { c.softnesses = {0.5}; })), InputError);
  EXPECT_THROW(listCases(with([](auto& c) { c.iterations = {0}; })), InputError);
  EXPECT_THROW(listCases(with([](auto& c) { c.fraction = 2; })), InputError);
}

}  // namespace
}  // namespace granular
