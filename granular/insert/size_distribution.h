// How large particles are: fixed, uniform, normal, log-normal, or a sieve curve, counted by number or by mass.
//
// By number: of N particles, N times the integral of f over [a, b] have a size between a and b. By mass: of a mass M of
// particles, M times that integral sits in particles of those sizes. Particles of one shape and density weigh size^3,
// so f_number(s) = f_mass(s) s^-3 / integral of f_mass s^-3: that is what is drawn, exactly and not from a table.
#pragma once

#include <string>
#include <vector>

#include "granular/core/random.h"

namespace granular {

enum class SizeKind : unsigned char { fixed, uniform, normal, logNormal, sieve };
enum class SizeWeight : unsigned char { number, mass };

/// Sizes have any unit, or none (a multiplier).
struct SizeOptions {
  SizeKind kind = SizeKind::fixed;
  SizeWeight weight = SizeWeight::number;
  double value = 1;                ///< fixed
  double mean = 1, deviation = 0;  ///< normal, logNormal: mean and standard deviation of the size before the cut-offs
  /// uniform: the ends. normal and logNormal: cut-offs; in any case they end six deviations (of the size, or of its
  /// logarithm) away from the middle.
  double min = 0, max = infinity;
  /// sieve: openings, ascending, and the fraction finer than each, from 0 to 1; linear in size between openings.
  std::vector<double> sizes, passing;
};

class SizeDistribution {
 public:
  /// Throws InputError for a size that is not positive, an empty range, a sieve curve that does not rise from 0 to 1.
  explicit SizeDistribution(const SizeOptions& options);

  /// A size, distributed by number: what one particle after another is given.
  double draw(Random& random) const;

  /// No size drawn lies outside.
  double smallest() const { return lo; }
  double largest() const { return hi; }

  /// "uniform 1 to 2 by mass", for messages.
  std::string describe() const;

 private:
  /// One class of a sieve curve: its share by number, cumulated, and its ends.
  struct Class {
    double cumulated, lo, hi;
  };
  /// One cell of the piecewise constant bound of a density from which draw() rejects.
  struct Cell {
    double cumulated, lo, hi, bound;
  };

  void setFixed(double size);
  void setUniform();
  void setNormal();
  void setLogNormal();
  void setSieve();
  void cutOff(double from, double to);
  void makeCells(double from, double to);
  double density(double t) const;
  double drawBetween(double from, double to, Random& random) const;
  double drawFromCells(Random& random) const;

  SizeOptions given;
  double lo = 0, hi = 0;
  // The Gaussian behind normal (in the size) and logNormal (in its logarithm); see density().
  double middle = 0, width = 0;
  bool inverseCube = false;
  std::vector<Class> classes;
  std::vector<Cell> cells;
};

}  // namespace granular
