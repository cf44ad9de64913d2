// What a tower is built of, and the towers themselves: sizes, places, and what counts as fallen.
#pragma once

#include <vector>

#include "granular/law/law.h"
#include "granular/point/contact_point.h"

namespace granular {

struct StackSettings {
  enum class Start { equilibrium, drop };
  int count = 10;
  double time = 1;            ///< s
  double side = 3e-3;         ///< of a cube, m
  double height = 0;          ///< of a cuboid, m; 0: as the side
  std::vector<double> sizes;  ///< factors on side and height, repeated up the tower; none: all 1
  double density = 2500;      ///< kg/m^3
  ContactParameters contact;  ///< S table 7
  LawKind law = LawKind::linear;
  LawOptions lawOptions;
  RuleOptions rule;
  double gravity = 9.81;  ///< m/s^2
  double step = 0;        ///< s; 0: the fraction of the stability bound
  double fraction = 0.5;
  double perturbation = 0;  ///< places by up to this times the side, orientations by up to this in rad
  std::uint64_t seed = 1;
  double sway = 0;  ///< the top starts off by this times the side, along the lowest sway mode
  Start start = Start::equilibrium;
  double gap = 1e-2;          ///< of a drop, between neighbours, over the side
  bool skip = false;          ///< use the library's shortcuts
  double sampleEvery = 1e-3;  ///< s
  double fallenDrift = 0.5;   ///< over the side: a cuboid further from its place has fallen
  double fallenTilt = 0.2;    ///< rad
  int solverIterations = 10;  ///< Bullet's, runBulletStack alone
};

/// Half-lengths of cuboid k from the ground, m.
Vec3 halfLengths(const StackSettings& settings, int k);
/// Its mass, kg.
double massOf(const StackSettings& settings, int k);
/// Stiffness of the face contact below cuboid k under the rule foundation, over k_n.
double foundationShare(const StackSettings& settings, int k);
/// Where the tower starts, from the ground up, the ground at z = 0.
std::vector<Pose> placeStack(const StackSettings& settings);
/// Throws InputError naming the value and its limit.
void checkStack(const StackSettings& settings);

}  // namespace granular
