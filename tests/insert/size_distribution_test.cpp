#include "granular/insert/size_distribution.h"

#include <gtest/gtest.h>

#include <functional>

#include "granular/core/errors.h"

namespace granular {
namespace {

constexpr int drawCount = 200000;

std::vector<double> drawMany(const SizeOptions& options, std::uint64_t seed = 5) {
  const SizeDistribution distribution(options);
  Random random(seed);
  std::vector<double> sizes(drawCount);
  for (double& s : sizes) {
    s = distribution.draw(random);
    EXPECT_GE(s, distribution.smallest());
    EXPECT_LE(s, distribution.largest());
  }
  return sizes;
}

double cube(double s) { return s * s * s; }

/// Checks that the mean of f over the draws is `expected`, within five of its own standard errors.
void expectMean(const std::vector<double>& sizes, const std::function<double(double)>& f, double expected,
                const char* what) {
  double sum = 0, squares = 0;
  for (double s : sizes) {
    sum += f(s);
    squares += f(s) * f(s);
  }
  const double n = double(sizes.size());
  const double error = std::sqrt(std::max(0.0, squares / n - (sum / n) * (sum / n)) / n);
  EXPECT_NEAR(sum / n, expected, 5 * error + 1e-12 * std::abs(expected)) << what;
}

/// Mean of f(s) by number, where the density by the options' weight is `density` on [lo, hi] (Simpson's rule).
double integrateMean(const std::function<double(double)>& density, bool byMass, double lo, double hi,
                     const std::function<double(double)>& f) {
  const int n = 20000;
  double upper = 0, lower = 0;
  for (int k = 0; k <= n; ++k) {
    const double s = lo + (hi - lo) * k / n;
    const double weight = (k == 0 || k == n) ? 1 : (k % 2 ? 4 : 2);
    const double byNumber = byMass ? density(s) / cube(s) : density(s);
    upper += weight * byNumber * f(s);
    lower += weight * byNumber;
  }
  return upper / lower;
}

void expectDensity(const SizeOptions& options, const std::function<double(double)>& density, double lo, double hi) {
  const std::vector<double> sizes = drawMany(options);
  const bool byMass = options.weight == SizeWeight::mass;
  for (const double power : {-3.0, -1.0, 1.0, 2.0, 3.0}) {
    const auto f = [&](double s) { return std::pow(s, power); };
    expectMean(sizes, f, integrateMean(density, byMass, lo, hi, f),
               options.weight == SizeWeight::mass ? "mass" : "number");
  }
}

TEST(SizeDistribution, FixedSizeNeedsNoRandomNumber) {
  SizeOptions options;
  options.value = 2.5;
  const SizeDistribution distribution(options);
  Random random(1);
  const auto before = random.state();
  EXPECT_EQ(distribution.draw(random), 2.5);
  EXPECT_EQ(random.state(), before);
}

TEST(SizeDistribution, UniformHasItsMomentsByNumberAndByMass) {
  for (const SizeWeight weight : {SizeWeight::number, SizeWeight::mass}) {
    SizeOptions options;
    options.kind = SizeKind::uniform;
    options.weight = weight;
    options.min = 1;
    options.max = 4;
    expectDensity(
        options, [](double) { return 1.0; }, 1, 4);
  }
}

TEST(SizeDistribution, TruncatedNormalHasItsMomentsByNumberAndByMass) {
  for (const SizeWeight weight : {SizeWeight::number, SizeWeight::mass}) {
    for (const auto& [lo, hi] : {std::pair{0.2, 3.0}, std::pair{1.5, 2.9}, std::pair{0.05, 0.6}}) {
      SizeOptions options;
      options.kind = SizeKind::normal;
      options.weight = weight;
      options.mean = 1;
      options.deviation = 0.4;
      options.min = lo;
      options.max = hi;
      expectDensity(
          options, [](double s) { return std::exp(-(s - 1) * (s - 1) / (2 * 0.16)); }, lo, hi);
    }
  }
}

TEST(SizeDistribution, LogNormalMeanAndDeviationAreThoseOfTheSize) {
  SizeOptions options;
  options.kind = SizeKind::logNormal;
  options.mean = 3e-3;
  options.deviation = 1e-3;
  const std::vector<double> sizes = drawMany(options);
  expectMean(
      sizes, [](double s) { return s; }, 3e-3, "mean");
  expectMean(
      sizes, [](double s) { return (s - 3e-3) * (s - 3e-3); }, 1e-6, "variance");
}

TEST(SizeDistribution, LogNormalByMassHasItsMeanByMass) {
  SizeOptions options;
  options.kind = SizeKind::logNormal;
  options.weight = SizeWeight::mass;
  options.mean = 2;
  options.deviation = 0.5;
  const std::vector<double> sizes = drawMany(options);
  // Means over the mass: sum of s^3 f / sum of s^3, tested as sum of s^3 (f - expected) = 0.
  expectMean(
      sizes, [](double s) { return cube(s) * (s - 2); }, 0, "mean by mass");
  expectMean(
      sizes, [](double s) { return cube(s) * ((s - 2) * (s - 2) - 0.25); }, 0, "variance by mass");
}

TEST(SizeDistribution, TruncatedLogNormalHasItsMomentsByNumberAndByMass) {
  const double variance = std::log1p(0.25), middle = -variance / 2;
  for (const SizeWeight weight : {SizeWeight::number, SizeWeight::mass}) {
    SizeOptions options;
    options.kind = SizeKind::logNormal;
    options.weight = weight;
    options.mean = 1;
    options.deviation = 0.5;
    options.min = 0.4;
    options.max = 1.7;
    expectDensity(
        options,
        [&](double s) { return std::exp(-(std::log(s) - middle) * (std::log(s) - middle) / (2 * variance)) / s; }, 0.4,
        1.7);
  }
}

TEST(SizeDistribution, SieveCurveIsReproducedByWhatIsCounted) {
  for (const SizeWeight weight : {SizeWeight::number, SizeWeight::mass}) {
    SizeOptions options;
    options.kind = SizeKind::sieve;
    options.weight = weight;
    options.sizes = {0.5e-3, 1e-3, 2e-3, 2.5e-3, 4e-3};
    options.passing = {0, 0.1, 0.1, 0.6, 1};
    const std::vector<double> sizes = drawMany(options);
    // Fraction finer than s, at openings and between, where the curve is linear.
    for (const auto& [opening, fraction] :
         {std::pair{0.75e-3, 0.05}, std::pair{1e-3, 0.1}, std::pair{1.7e-3, 0.1}, std::pair{2.25e-3, 0.35},
          std::pair{2.5e-3, 0.6}, std::pair{3.25e-3, 0.8}}) {
      const double power = weight == SizeWeight::mass ? 3 : 0;
      expectMean(
          sizes,
          [&, s0 = opening, f0 = fraction](double s) { return std::pow(s * 1e3, power) * ((s < s0 ? 1.0 : 0.0) - f0); },
          0, weight == SizeWeight::mass ? "by mass" : "by number");
    }
  }
}

TEST(SizeDistribution, EmptySieveClassIsNeverDrawn) {
  SizeOptions options;
  options.kind = SizeKind::sieve;
  options.sizes = {1, 2, 3, 4};
  options.passing = {0, 0.5, 0.5, 1};
  for (double s : drawMany(options)) ASSERT_TRUE(s <= 2 || s >= 3) << s;
}

TEST(SizeDistribution, SameSeedGivesTheSameSizes) {
  SizeOptions options;
  options.kind = SizeKind::normal;
  options.mean = 1;
  options.deviation = 0.1;
  EXPECT_EQ(drawMany(options, 9), drawMany(options, 9));
  EXPECT_NE(drawMany(options, 9), drawMany(options, 10));
}

TEST(SizeDistribution, ImpossibleOptionsAreRefusedWithTheirValues) {
  const auto message = [](const SizeOptions& options) -> std::string {
    try {
      SizeDistribution{options};
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  SizeOptions options;
  options.value = -2;
  EXPECT_NE(message(options).find("-2"), std::string::npos);

  options.kind = SizeKind::uniform;
  options.min = 3;
  options.max = 2;
  EXPECT_NE(message(options).find("below the lower end 3"), std::string::npos);

  options.kind = SizeKind::normal;
  options.mean = 1;
  options.deviation = 0.5;
  options.min = 0;
  options.max = infinity;
  EXPECT_NE(message(options).find("give a lower cut-off"), std::string::npos);

  options.kind = SizeKind::logNormal;
  options.min = 1e6;
  EXPECT_NE(message(options).find("nothing lies between"), std::string::npos);

  options.kind = SizeKind::sieve;
  options.sizes = {1, 2};
  options.passing = {0, 0.9};
  EXPECT_NE(message(options).find("0 to 0.9"), std::string::npos);
  options.sizes = {2, 1};
  options.passing = {0, 1};
  EXPECT_NE(message(options).find("ascend"), std::string::npos);
}

}  // namespace
}  // namespace granular
