// Towers of cuboids: what stands, what buckles, and how fast it sways, against the eigenvalue problem.
#include "granular/run/stack.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <tuple>

#include "granular/core/errors.h"
#include "granular/run/stack_modes.h"
#include "granular/run/stack_report.h"
#include "io/scratch_folder.h"
#include "run/scene_texts.h"

namespace granular {
namespace {

StackSettings makeTower(PointRule rule, int count) {
  StackSettings settings;
  settings.rule.rule = rule;
  settings.count = count;
  settings.skip = true;
  return settings;
}

int bucklingCount(StackSettings settings) {
  // The first that buckles; more cuboids never stand better.
  int stands = 1, falls = 400;
  while (falls - stands > 1) {
    settings.count = (stands + falls) / 2;
    (findLowestSway(settings).square < 0 ? falls : stands) = settings.count;
  }
  return falls;
}

TEST(TowerModes, BuckleWhereAnElasticColumnDoes) {
  // Continuum: N^3 = 7.837 k_theta/(m g s), k_theta = 2 p k_n s^2/12 (p: sharpness; 2 p = 1 for a patch).
  for (const int sharpness : {0, 3, 24, 200}) {
    StackSettings settings = makeTower(sharpness == 0 ? PointRule::patch : PointRule::stiffPatch, 1);
    settings.rule.sharpness = std::max(1, sharpness);
    const double multiple = sharpness == 0 ? 1 : 2.0 * sharpness;
    const double rocking = multiple * settings.contact.stiffness * settings.side * settings.side / 12;
    const double weight = massOf(settings, 0) * settings.gravity;
    const double continuum = std::cbrt(7.837 * rocking / (weight * settings.side));
    // Neither shear nor the granularity moves it by more than two cuboids or 2 %.
    EXPECT_NEAR(bucklingCount(settings), continuum + 0.5, std::max(2.0, 0.02 * continuum)) << sharpness;
  }
}

TEST(TowerModes, OfPatchesBuckleAtThirtyOneCubesOfThePaper) {
  EXPECT_EQ(bucklingCount(makeTower(PointRule::patch, 1)), 31);
}

/// Time of the first largest drift, refined by a parabola; the sway is back where it began, on the other side.
double halfPeriod(const StackResult& result) {
  const auto& s = result.samples;
  for (std::size_t k = 1; k + 1 < s.size(); ++k) {
    const double a = s[k - 1].drift, b = s[k].drift, c = s[k + 1].drift;
    if (b >= a && b > c) return s[k].time + 0.5 * (a - c) / (a - 2 * b + c) * (s[k].time - s[k - 1].time);
  }
  return infinity;
}

TEST(Tower, SwaysAsItsLowestMode) {
  for (const PointRule rule : {PointRule::patch, PointRule::stiffPatch, PointRule::foundation}) {
    StackSettings settings = makeTower(rule, 25);
    settings.rule.sharpness = 2;
    settings.sway = 1e-6;
    const double omega = std::sqrt(findLowestSway(settings).square);
    settings.time = 1.3 * pi / omega;
    settings.sampleEvery = settings.time / 200;
    const StackResult result = runStack(settings);
    EXPECT_TRUE(result.standing);
    // The dashpots shift a mode of small damping zeta by zeta^2/2: far less than the percent left to lift-off at the
    // top.
    EXPECT_NEAR(pi / halfPeriod(result), omega, 0.01 * omega) << pointRuleName(rule);
  }
}

TEST(Tower, HigherThanItsBucklingHeightFallsAsFastAsItsModeGrows) {
  StackSettings settings = makeTower(PointRule::patch, 35);
  settings.sway = 1e-7;
  const double rate = std::sqrt(-findLowestSway(settings).square);
  settings.time = 6 / rate;
  settings.sampleEvery = settings.time / 100;
  const StackResult result = runStack(settings);
  // drift = sway (cosh(rate t) - 1): compare two times far from the start.
  const auto& s = result.samples;
  const auto growth = [&](std::size_t k) { return std::acosh(1 + s[k].drift / settings.sway); };
  const std::size_t early = s.size() / 2, late = s.size() - 1;
  EXPECT_NEAR((growth(late) - growth(early)) / (s[late].time - s[early].time), rate, 0.05 * rate);
}

TEST(Tower, CarriesTheWeightAboveEachLayer) {
  for (const PointRule rule : {PointRule::patch, PointRule::stiffPatch, PointRule::foundation}) {
    StackSettings settings = makeTower(rule, 10);
    settings.time = 0.02;
    const StackResult result = runStack(settings);
    EXPECT_LT(result.worstInterlayer, 1e-6) << pointRuleName(rule);
    EXPECT_LT(result.maxDrift, 1e-9) << pointRuleName(rule);
  }
}

TEST(Tower, OfUnequalCuboidsStandsInEquilibrium) {
  StackSettings settings = makeTower(PointRule::stiffPatch, 6);
  settings.sizes = {1, 0.5};
  settings.time = 0.02;
  const StackResult result = runStack(settings);
  EXPECT_TRUE(result.standing);
  EXPECT_LT(result.worstInterlayer, 1e-5);
}

TEST(Tower, IsTheSameWithAndWithoutShortcuts) {
  StackSettings settings = makeTower(PointRule::stiffPatch, 8);
  settings.perturbation = 1e-4;
  settings.time = 0.01;
  const StackResult fast = runStack(settings);
  settings.skip = false;
  const StackResult slow = runStack(settings);
  for (std::size_t k = 0; k < fast.poses.size(); ++k) {
    EXPECT_NEAR((fast.poses[k].x - slow.poses[k].x).norm(), 0, 1e-9 * settings.side);
  }
}

TEST(Tower, OfBulletCarriesItsWeightToo) {
  StackSettings settings = makeTower(PointRule::patch, 5);
  settings.contact.restitution = 1e-9;
  settings.contact.friction = 0.5;
  settings.step = 1e-3;
  settings.time = 0.5;
  const StackResult result = runBulletStack(settings);
  EXPECT_TRUE(result.standing);
  EXPECT_LT(result.worstInterlayer, 0.05);
}

class TowerCheckpoint : public ScratchFolder {
 protected:
  static StackSettings makeShaken() {
    StackSettings settings = makeTower(PointRule::stiffPatch, 6);
    settings.perturbation = 1e-3;
    settings.time = 0.02;
    return settings;
  }

  static void expectSame(const StackResult& a, const StackResult& b) {
    EXPECT_EQ(a.steps, b.steps);
    EXPECT_EQ(a.simulated, b.simulated);
    EXPECT_EQ(a.fellAt, b.fellAt);
    EXPECT_EQ(a.maxDrift, b.maxDrift);
    EXPECT_EQ(a.maxTilt, b.maxTilt);
    EXPECT_EQ(a.kineticEnergy, b.kineticEnergy);
    EXPECT_EQ(a.energyTrend, b.energyTrend);
    EXPECT_EQ(a.worstInterlayer, b.worstInterlayer);
    EXPECT_EQ(a.deepestOverlap, b.deepestOverlap);
    ASSERT_EQ(a.samples.size(), b.samples.size());
    for (std::size_t k = 0; k < a.samples.size(); ++k) {
      const StackSample &x = a.samples[k], &y = b.samples[k];
      EXPECT_EQ(std::tie(x.time, x.kineticEnergy, x.speed, x.drift, x.tilt),
                std::tie(y.time, y.kineticEnergy, y.speed, y.drift, y.tilt))
          << k;
    }
    ASSERT_EQ(a.poses.size(), b.poses.size());
    for (std::size_t k = 0; k < a.poses.size(); ++k) {
      EXPECT_EQ(a.poses[k].x, b.poses[k].x);
      EXPECT_EQ(a.poses[k].q.coeffs(), b.poses[k].q.coeffs());
    }
  }

  /// Stops at the samples of these numbers, and compares the end with that of an undisturbed run.
  void expectSameEnd(const StackSettings& settings, const std::vector<int>& stops) {
    const StackResult whole = runStack(settings);
    std::optional<StackResult> last;
    for (const int stop : stops) {
      const auto watch = [&](const StackSample& sample) {
        return std::lround(sample.time / settings.sampleEvery) != stop;
      };
      StackRun part = last ? StackRun::resumed(folder) : StackRun(settings);
      last = part.run(watch, {folder});
      ASSERT_TRUE(last->stopped);
    }
    last = StackRun::resumed(folder).run();
    EXPECT_FALSE(last->stopped);
    expectSame(whole, *last);
  }
};

TEST_F(TowerCheckpoint, EveryRuleEndsInTheSameBits) {
  for (int rule = 0; rule <= static_cast<int>(PointRule::foundation); ++rule) {
    StackSettings settings = makeShaken();
    settings.rule.rule = static_cast<PointRule>(rule);
    SCOPED_TRACE(pointRuleName(settings.rule.rule));
    expectSameEnd(settings, {7});
  }
}

TEST_F(TowerCheckpoint, EveryLawOfATowerEndsInTheSameBits) {
  for (const LawKind law : {LawKind::linear, LawKind::linearLocal, LawKind::tensor}) {
    StackSettings settings = makeShaken();
    settings.law = law;
    SCOPED_TRACE(lawName(law));
    expectSameEnd(settings, {1, 2, 13, 19});
  }
}

TEST_F(TowerCheckpoint, OfUnequalCuboidsDroppedWithNothingSkippedEndsInTheSameBits) {
  StackSettings settings = makeShaken();
  settings.sizes = {1, 0.5, 0.7};
  settings.start = StackSettings::Start::drop;
  settings.skip = false;
  expectSameEnd(settings, {3, 11});
}

TEST_F(TowerCheckpoint, OfATowerThatFallsEndsInTheSameBits) {
  StackSettings settings = makeTower(PointRule::patch, 35);
  settings.sway = 5e-2;
  settings.time = 2;
  settings.sampleEvery = 2e-3;
  settings.fallenDrift = 0.2;
  StackResult whole = runStack(settings);
  ASSERT_FALSE(whole.standing);
  expectSameEnd(settings, {static_cast<int>(whole.samples.size()) - 1});
}

TEST_F(TowerCheckpoint, WrittenOnTheWayIsAsGoodAndMayBeGivenMoreTime) {
  StackSettings settings = makeShaken();
  // So often that every sample has one; the steps don't divide the time, so that the last sample comes early.
  const StackResult shorter = StackRun(settings).run({}, {folder, 1e-9});
  const double last = StackRun::resumed(folder).time();
  EXPECT_GT(last, 0.9 * settings.time);
  EXPECT_LT(last, shorter.simulated);
  settings.time = 0.03;
  expectSame(runStack(settings), StackRun::resumed(folder, 0.03).run());
}

TEST_F(TowerCheckpoint, ThatCannotBeUsedIsRefusedWithTheReason) {
  const auto refusal = [&](std::optional<double> time) {
    try {
      StackRun::resumed(folder, time);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  expectMentions(refusal({}), {"checkpoint.h5", "no such checkpoint"});
  const StackSettings settings = makeShaken();
  StackRun(settings).run([](const StackSample& sample) { return sample.time < 0.01; }, {folder});
  expectMentions(refusal(0.005), {"time = 0.005 s", "already at"});
  try {
    PackingRun::resumed(folder);
    FAIL();
  } catch (const InputError& error) {
    expectMentions(error.what(), {folder.string(), "not that of a packing"});
  }
}

TEST(Tower, RefusesSettingsThatMeanNothing) {
  StackSettings settings = makeTower(PointRule::witness, 5);
  settings.sway = 1e-3;
  EXPECT_THROW(runStack(settings), InputError);
  settings = makeTower(PointRule::patch, 0);
  EXPECT_THROW(runStack(settings), InputError);
  settings = makeTower(PointRule::patch, 5);
  settings.step = 1;
  EXPECT_THROW(runStack(settings), InputError);
  settings.step = 0;
  EXPECT_THROW(runBulletStack(settings), InputError);
}

}  // namespace
}  // namespace granular
